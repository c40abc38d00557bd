#pragma once

#include <string>
#include <string_view>

namespace motorcade {

/// Address at which a server listens.
struct ListenAddress {
  std::string host = "127.0.0.1";
  int port = 8080;  // 0 for any that is free

  /// Text for URLs; an IPv6 address is in brackets.
  std::string text() const;
  /// Reachable from this machine alone.
  bool loopback() const;
  /// All addresses of the machine.
  bool everywhere() const;
  /// Variant of `text` that a browser on this machine can open.
  std::string localText() const;
};

/// Reads ADDR:PORT, ADDR, :PORT or PORT, with an IPv6 address in brackets. Missing parts keep the defaults above.
/// Throws UsageError, naming the option.
ListenAddress parseListenAddress(std::string_view text, std::string_view option);

/// The warning for an address that other machines can reach, in one line; empty for this machine's own.
std::string exposureWarning(const ListenAddress& address);

}  // namespace motorcade
