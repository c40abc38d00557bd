#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

#include "apps/interface/c_interface_error.hpp"

namespace motorcade {

/// The smallest struct that is accepted: it ends behind the members that it must have. Members after them may be
/// missing in an older program's struct.
template <class Struct>
inline constexpr std::size_t kLeast_bytes = sizeof(std::size_t) + 1;
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_lens> = offsetof(motorcade_lens, distortion);
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_rig> = sizeof(motorcade_rig);
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_camera> = offsetof(motorcade_camera, rig);
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_image> = offsetof(motorcade_image, format);
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_pair> = offsetof(motorcade_pair, frame);
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_vehicle_motion> = offsetof(motorcade_vehicle_motion,
                                                                               speed_sigma_mps);
template <>
inline constexpr std::size_t kLeast_bytes<motorcade_push> = offsetof(motorcade_push, why);

inline void require(const void* pointer, const char* name) {
  if (pointer == nullptr) throw CallError(MOTORCADE_ERROR_NULL, name, "is NULL; it must point to what its name says");
}

/// Largest size of a struct. A larger number is taken for memory that was never set.
inline constexpr std::size_t kMost_bytes = 4096;

template <class Struct>
void requireStruct(const Struct* given, const char* name) {
  require(given, name);
  if (given->struct_size >= kLeast_bytes<Struct> && given->struct_size <= kMost_bytes) return;
  throw CallError(MOTORCADE_ERROR_STRUCT_SIZE, std::string(name) + ".struct_size",
                  "is " + std::to_string(given->struct_size) + "; set it to the struct's sizeof, here " +
                      std::to_string(sizeof(Struct)) + ", before the call");
}

/// Bytes of the caller's struct that this version knows, which may be all.
template <class Struct>
std::size_t knownBytes(const Struct* given) {
  return std::min(sizeof(Struct), given->struct_size);
}

/// The caller's struct, with `defaults` where it has no member.
template <class Struct>
Struct readStruct(const Struct* given, const char* name, Struct defaults) {
  requireStruct(given, name);
  const auto* bytes = reinterpret_cast<const std::byte*>(given);
  if (std::any_of(bytes + knownBytes(given), bytes + given->struct_size,
                  [](std::byte byte) { return byte != std::byte{0}; }))
    throw CallError(MOTORCADE_ERROR_STRUCT_SIZE, std::string(name) + ".struct_size",
                    "is " + std::to_string(given->struct_size) + ", and what follows the " +
                        std::to_string(sizeof(Struct)) + " bytes that this library (" + version() +
                        ") knows is not zero; it wants a newer one");
  std::memcpy(&defaults, given, knownBytes(given));
  return defaults;
}

/// Fills in as many members as the caller's struct has. Call `requireStruct` first. Its size stays.
template <class Struct>
void writeStruct(Struct values, Struct* asked) {
  values.struct_size = asked->struct_size;
  std::memcpy(asked, &values, knownBytes(asked));
}

/// Fills in the defaults; additional members of a newer program's struct become zero.
template <class Struct>
motorcade_code initStruct(Struct* asked, const char* name, const Struct& defaults) {
  return guarded([&] {
    requireStruct(asked, name);
    writeStruct(defaults, asked);
    auto* bytes = reinterpret_cast<std::byte*>(asked);
    std::fill(bytes + knownBytes(asked), bytes + asked->struct_size, std::byte{0});
    return MOTORCADE_OK;
  });
}

}  // namespace motorcade
