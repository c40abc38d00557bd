#pragma once

#include <span>
#include <string_view>

namespace motorcade {

/// A file of the page, compiled into the program.
struct Asset {
  const char *path, *type;
  std::string_view content;
};

std::span<const Asset> assets();

}  // namespace motorcade
