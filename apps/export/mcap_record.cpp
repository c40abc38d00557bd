#include "apps/export/mcap_record.hpp"

#include <zlib.h>

namespace motorcade::mcap {

Fields& Fields::number(std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) content_ += static_cast<char>((value >> (8 * i)) & 0xFF);
  return *this;
}

Fields& Fields::text(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size()));
  return bytes(value);
}

Fields& Fields::bytes(std::string_view value) {
  content_ += value;
  return *this;
}

Fields& Fields::map(const std::map<std::uint16_t, std::uint64_t>& value) {
  constexpr std::size_t kPair_bytes = 10;
  u32(static_cast<std::uint32_t>(kPair_bytes * value.size()));
  for (const auto& [key, number] : value) u16(key).u64(number);
  return *this;
}

Fields& Fields::map(const Texts& value) {
  Fields pairs;
  for (const auto& [key, what] : value) pairs.text(key).text(what);
  return text(pairs.content());
}

std::uint64_t append(std::string& records, Opcode opcode, const Fields& fields) {
  const std::size_t start = records.size();
  records += Fields().u8(static_cast<std::uint8_t>(opcode)).u64(fields.content().size()).content();
  records += fields.content();
  return records.size() - start;
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace motorcade::mcap
