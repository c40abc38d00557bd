#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "io/bag/mcap_format.hpp"

namespace motorcade::mcap {

/// Texts by their names, in an order of their own.
using Texts = std::map<std::string, std::string>;

/// The content of a record, field by field: numbers with the lowest byte first, strings and maps after their length.
class Fields {
 public:
  Fields& u8(std::uint8_t value) { return number(value, 1); }
  Fields& u16(std::uint16_t value) { return number(value, 2); }
  Fields& u32(std::uint32_t value) { return number(value, 4); }
  Fields& u64(std::uint64_t value) { return number(value, 8); }
  Fields& text(std::string_view value);
  /// Bytes up to the end of the record.
  Fields& bytes(std::string_view value);
  /// A map keyed by the channels' numbers.
  Fields& map(const std::map<std::uint16_t, std::uint64_t>& value);
  Fields& map(const Texts& value);

  const std::string& content() const { return content_; }

 private:
  Fields& number(std::uint64_t value, int bytes);

  std::string content_;
};

/// Appends a whole record; returns its length with its header.
std::uint64_t append(std::string& records, Opcode opcode, const Fields& fields);

/// CRC-32 as in zlib; `before` is the sum of the bytes before these.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace motorcade::mcap
