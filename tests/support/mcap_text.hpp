#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// MCAP files byte by byte, by their specification alone.
namespace motorcade::test {

/// The content of a record, and records.
class McapText {
 public:
  McapText& u8(std::uint8_t value) { return number(value, 1); }
  McapText& u16(std::uint16_t value) { return number(value, 2); }
  McapText& u32(std::uint64_t value) { return number(value, 4); }
  McapText& u64(std::uint64_t value) { return number(value, 8); }
  McapText& plain(std::string_view value) {
    text_ += value;
    return *this;
  }
  McapText& word(std::string_view value) { return u32(value.size()).plain(value); }
  McapText& record(std::uint8_t opcode, const McapText& content) {
    return u8(opcode).u64(content.text_.size()).plain(content.text_);
  }

  McapText& magic() { return plain({"\x89MCAP0\r\n", 8}); }
  McapText& header() { return record(0x01, McapText().word("ros2").word("test")); }
  McapText& topic(std::uint16_t number, std::string_view name, std::string_view type,
                  std::string_view encoding = "cdr") {
    record(0x03, McapText().u16(number).word(type).word("ros2msg").word("# none"));
    return record(0x04, McapText().u16(number).u16(number).word(name).word(encoding).u32(0));
  }
  McapText& message(std::uint16_t topic, std::uint64_t log_ns, std::string_view data) {
    return record(0x05, McapText().u16(topic).u32(0).u64(log_ns).u64(log_ns).plain(data));
  }
  /// `stored` are the records as the compression leaves them.
  McapText& chunk(std::string_view compression, std::string_view stored, std::uint64_t size, std::uint32_t sum = 0) {
    return record(0x06, McapText().u64(0).u64(0).u64(size).u32(sum).word(compression).u64(stored.size()).plain(stored));
  }
  /// The end of a file without a summary.
  McapText& end() { return record(0x0F, McapText().u32(0)).record(0x02, McapText().u64(0).u64(0).u32(0)).magic(); }

  const std::string& text() const { return text_; }

 private:
  McapText& number(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) text_ += static_cast<char>(value >> (8 * i) & 0xFF);
    return *this;
  }

  std::string text_;
};

}  // namespace motorcade::test
