#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Facts about a request and its origin; a missing header is empty.
struct RequestFacts {
  std::string method, path;
  std::string host, origin, fetch_site;  // the headers Host, Origin and Sec-Fetch-Site
  std::string token;                     // of a control call
};

struct Refusal {
  int status = 0;
  std::string sentence;
};

/// Keeps other pages of the same browser out. A name that somebody else's server gives to this address (DNS rebinding)
/// is no name of this server. Another site's scripts may neither read nor control. Only GET and HEAD are answered.
class RequestGuard {
 public:
  explicit RequestGuard(const ListenAddress& listening);

  /// Empty where the request may be answered.
  std::optional<Refusal> refusalOf(const RequestFacts& request) const;
  /// Token that every control call must carry. The server never sends it: it is in the URL printed for the user,
  /// behind the `#`, and browsers do not transmit that part.
  const std::string& token() const { return token_; }

 private:
  bool isOwnName(const std::string& host) const;

  std::vector<std::string> names_;  // with port
  bool any_address_;                // reachable under every address of the machine
  std::string port_, token_;
};

}  // namespace motorcade
