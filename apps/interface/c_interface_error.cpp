#include "apps/interface/c_interface_error.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace motorcade {
namespace {

struct LastError {
  std::array<char, 1024> message{};
  std::array<char, 128> field{};
};

thread_local LastError last_error;

template <std::size_t kRoom>
void keep(std::array<char, kRoom>& text, const char* given) {
  const std::size_t length = std::min(std::strlen(given), kRoom - 1);
  std::memcpy(text.data(), given, length);
  text[length] = '\0';
}

}  // namespace

motorcade_code failed(motorcade_code code, const char* field, const char* message) noexcept {
  keep(last_error.message, message);
  keep(last_error.field, field);
  return code;
}

}  // namespace motorcade

const char* motorcade_last_error() { return motorcade::last_error.message.data(); }
const char* motorcade_last_error_field() { return motorcade::last_error.field.data(); }
const char* motorcade_version() { return motorcade::version(); }
