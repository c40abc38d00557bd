#include "apps/view/listen_address.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

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

}  // namespace motorcade
