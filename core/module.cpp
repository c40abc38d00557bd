#include "core/module.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <string_view>

#include <dlfcn.h>

namespace motorcade {
namespace {

constexpr char kHere = 0;  // lies in the library or program that holds this code

/// Takes a number in base 16, and the character after it.
std::uintptr_t takeHex(std::string_view& text) {
  std::uintptr_t value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value, 16).ptr;
  text.remove_prefix(std::min(static_cast<std::size_t>(end - text.data()) + 1, text.size()));
  return value;
}

std::filesystem::path fileOf(const std::string& name) {
  const std::filesystem::path here = fileOfAddress(&kHere);
  if (here.empty()) throw ModuleError(name + ".so cannot be looked for: mount /proc, which tells its folder");
  return here.parent_path() / "motorcade" / (name + ".so");
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& name, const std::string& problem) {
  throw ModuleError(file.string() + " " + problem +
                    "; install the package " MOTORCADE_MODULES_PACKAGE
                    " of this version, or build the target motorcade_" +
                    name + "_module");
}

}  // namespace

std::filesystem::path fileOfAddress(const void* address) {
  const auto sought = reinterpret_cast<std::uintptr_t>(address);
  std::ifstream maps("/proc/self/maps");  // from-to rights offset device inode path
  for (std::string line; std::getline(maps, line);) {
    std::string_view rest = line;
    const std::uintptr_t from = takeHex(rest), to = takeHex(rest);
    const auto path = line.find('/');
    if (sought >= from && sought < to && path != std::string::npos) return line.substr(path);
  }
  return {};
}

void* moduleFunction(const std::string& name, const char* function) {
  const std::filesystem::path file = fileOf(name);
  std::error_code unreadable;
  if (!std::filesystem::exists(file, unreadable)) fail(file, name, "is not there");
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays; again, it gives the same one
  if (module == nullptr) fail(file, name, std::string("cannot be loaded (") + ::dlerror() + ")");
  void* const found = ::dlsym(module, function);
  if (found == nullptr) fail(file, name, std::string("is of another version, without ") + function);
  return found;
}

}  // namespace motorcade
