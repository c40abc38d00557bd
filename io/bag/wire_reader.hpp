#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace motorcade {

/// Encodings of a message's fields.
enum class WireFormat {
  kCdr,       // ROS 2: aligned, with a head that tells the order of bytes
  kRos1,      // packed, lowest byte first
  kProtobuf,  // Foxglove's; its fields are taken by ProtobufFields
};

/// Takes a message's fields one by one. A field beyond its bytes is an InputError that begins with `name`.
class WireReader {
 public:
  WireReader(std::span<const std::uint8_t> message, WireFormat format, std::string name);

  WireFormat format() const { return format_; }
  const std::string& name() const { return name_; }
  /// All bytes.
  std::span<const std::uint8_t> message() const { return message_; }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  double f64();
  void fill(std::span<double> values);
  std::string text();
  /// Bytes, preceded by their count.
  std::span<const std::uint8_t> bytes() { return take(u32()); }
  std::vector<double> doubles(std::size_t most);

  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::uint64_t number(std::size_t size);
  std::span<const std::uint8_t> take(std::size_t size);

  std::span<const std::uint8_t> message_;
  WireFormat format_;
  std::string name_;
  std::size_t position_ = 0, origin_ = 0;  // alignment counts from the second
  std::size_t most_alignment_ = 1;
  bool big_endian_ = false;
};

}  // namespace motorcade
