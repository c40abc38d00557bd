#include "apps/view/request_guard.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <random>

#include <unistd.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

constexpr int kMostPort = 65535;

std::optional<int> portOf(std::string_view text) {
  int port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port < 0 || port > kMostPort) return std::nullopt;
  return port;
}

bool allDigits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool isHostCharacter(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' || c == ':';
}

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

std::string randomToken() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string token;
  for (int i = 0; i < 32; ++i) token += kDigits[random() % kDigits.size()];
  return token;
}

std::string machineName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? lowered(name.data()) : "";
}

/// Compares in constant time, wherever the texts differ.
bool isSame(std::string_view a, std::string_view b) {
  unsigned char difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  return difference == 0;
}

/// True for an address. Another server's name cannot be an address, so that addresses are no way in for rebinding.
bool isAddress(std::string_view host) {
  if (host.starts_with('[')) return host.ends_with(']');
  return !host.empty() && std::ranges::all_of(host, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
}

}  // namespace

std::string ListenAddress::text() const {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

bool ListenAddress::loopback() const { return host.starts_with("127.") || host == "::1" || host == "localhost"; }

bool ListenAddress::everywhere() const { return host == "0.0.0.0" || host == "::"; }

std::string ListenAddress::localText() const {
  if (!everywhere()) return text();
  return ListenAddress{.host = host == "::" ? "::1" : "127.0.0.1", .port = port}.text();
}

std::string exposureWarning(const ListenAddress& address) {
  if (address.loopback()) return "";
  const std::string port = std::to_string(address.port);
  return "--view " + address.text() + ": whoever reaches this machine over the network sees the images and results, " +
         "unencrypted and without a password; only who has the printed address can hold the run. To see it from "
         "another "
         "machine alone, leave the address out and use ssh -L " +
         port + ":127.0.0.1:" + port + " there";
}

ListenAddress parseListenAddress(std::string_view text, std::string_view option) {
  ListenAddress address;
  std::string_view host = text, port;
  if (allDigits(text)) {
    host = {};
    port = text;
  } else if (const auto colon = text.rfind(':'); colon != std::string_view::npos && !text.ends_with(']')) {
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
  }
  const bool bracketed = host.size() > 2 && host.starts_with('[') && host.ends_with(']');
  if (bracketed) host = host.substr(1, host.size() - 2);
  if (!host.empty()) address.host = host;
  const auto number = port.empty() ? std::optional(address.port) : portOf(port);
  const bool plain =
      std::ranges::all_of(address.host, isHostCharacter) && (bracketed || address.host.find(':') == std::string::npos);
  if (!number || !plain || text.ends_with(':'))
    throw UsageError(std::string(option) + " " + std::string(text) +
                     ": write ADDR:PORT, such as 127.0.0.1:8080, with a port from 0 to 65535");
  address.port = *number;
  return address;
}

RequestGuard::RequestGuard(const ListenAddress& listening)
    : any_address_(listening.everywhere()),
      port_(std::string(":").append(std::to_string(listening.port))),
      token_(randomToken()) {
  names_ = {lowered(listening.text())};
  if (listening.loopback() || any_address_)
    for (const char* name : {"localhost", "127.0.0.1", "[::1]"}) names_.push_back(name + port_);
  if (const std::string name = machineName(); any_address_ && !name.empty()) names_.push_back(name + port_);
}

bool RequestGuard::isOwnName(const std::string& host) const {
  const std::string name = lowered(host.find(':', host.rfind(']') + 1) == std::string::npos ? host + ":80" : host);
  if (std::ranges::find(names_, name) != names_.end()) return true;
  return any_address_ && name.ends_with(port_) &&
         isAddress(std::string_view(name).substr(0, name.size() - port_.size()));
}

std::optional<Refusal> RequestGuard::refusalOf(const RequestFacts& request) const {
  if (request.method != "GET" && request.method != "HEAD") return Refusal{405, "Only GET and HEAD are answered here."};
  if (!isOwnName(request.host))
    return Refusal{403, "This is not the name of this server; open the address that motorcade printed."};
  if (!request.origin.empty() && lowered(request.origin) != "http://" + lowered(request.host))
    return Refusal{403, "Pages of other sites get no answer here."};
  const bool own = request.fetch_site.empty() || request.fetch_site == "same-origin" || request.fetch_site == "none";
  if (!own && request.path != "/") return Refusal{403, "Pages of other sites get no answer here."};
  if (!request.path.starts_with("/control/")) return std::nullopt;
  if (request.method != "GET") return Refusal{405, "A control call is a GET."};
  if (!isSame(request.token, token_))
    return Refusal{403, "Only a page that was opened with the address that motorcade printed may hold the run."};
  return std::nullopt;
}

}  // namespace motorcade
