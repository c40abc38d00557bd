#pragma once

#include <string>
#include <string_view>

namespace motorcade {

/// Where a server listens.
struct ListenAddress {
  std::string host = "127.0.0.1";
  int port = 8080;  // 0 for any that is free

  /// As it stands in URLs; an IPv6 address in brackets.
  std::string text() const;
};

/// Reads ADDR:PORT, ADDR, :PORT or PORT, with an IPv6 address in brackets; what is left out, or all, is as above.
/// Throws UsageError, naming the option.
ListenAddress parseListenAddress(std::string_view text, std::string_view option);

}  // namespace motorcade
