#include "apps/view/request_guard.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <string_view>

#include <unistd.h>

namespace motorcade {
namespace {

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
