#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "apps/view/page_source.hpp"
#include "apps/view/request_guard.hpp"
#include "apps/view/viewers.hpp"

namespace motorcade {

/// A file of the page, compiled into the program.
struct Asset {
  const char *path, *type;
  std::string_view content;
};

std::span<const Asset> assets();

/// Serves the page of a run (docs/view.md) on threads of its own, from memory alone. Source and viewers must outlive
/// it. Its threads give way to the pipeline's.
class PageServer {
 public:
  /// Throws OutputError, naming the address, if it cannot listen there. Logs a warning if other machines can reach it.
  PageServer(const ListenAddress& address, PageSource& source, Viewers& viewers);
  /// Closes the viewers' places and ends all answers under way within about a second.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  int port() const;
  /// URL of the page for a browser on this machine.
  std::string url() const;
  /// The same with the token that holds the run. The browser does not transmit the part behind `#`.
  std::string controlUrl() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace motorcade
