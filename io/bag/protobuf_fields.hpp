#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace motorcade {

/// Takes the fields of a Protobuf message one by one, whatever its schema. Throws InputError that begins with `name`
/// for anything else.
class ProtobufFields {
 public:
  struct Field {
    std::uint64_t number = 0;
    std::uint64_t value = 0;                // of a number; a double as its bits
    std::span<const std::uint8_t> bytes{};  // of a string, of bytes, of a message, of numbers in a row
  };
  ProtobufFields(std::span<const std::uint8_t> message, const std::string& name) : rest_(message), name_(name) {}

  /// Empty after the last field.
  std::optional<Field> next();

 private:
  std::span<const std::uint8_t> take(std::uint64_t size);
  std::uint64_t fixed(std::size_t size);
  std::uint64_t varint();

  std::span<const std::uint8_t> rest_;
  const std::string& name_;
};

}  // namespace motorcade
