#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace motorcade::mcap {

/// Takes fields from the front of a record's bytes: numbers with the lowest byte first, strings after their length. A
/// field beyond the record's end is an InputError that begins with `place`.
class RecordFields {
 public:
  RecordFields(std::span<const std::uint8_t> record, const std::string& place) : rest_(record), place_(place) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  /// A name, which is short.
  std::string text();
  std::span<const std::uint8_t> take(std::uint64_t size);
  std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::uint64_t number(std::size_t size);

  std::span<const std::uint8_t> rest_;
  const std::string& place_;
};

}  // namespace motorcade::mcap
