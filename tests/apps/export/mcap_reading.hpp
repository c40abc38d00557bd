#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

/// Reads MCAP files by their specification alone, with nothing of what writes them.
namespace motorcade::test {

inline const std::string kMcapMagic("\x89MCAP0\r\n", 8);

/// Takes fields from the front of a record.
class McapFields {
 public:
  explicit McapFields(std::string_view bytes) : rest_(bytes) {}

  template <class Number>
  Number number() {
    Number value{};
    if (rest_.size() < sizeof(value)) {
      ADD_FAILURE() << "a record is too short";
      return value;
    }
    std::memcpy(&value, rest_.data(), sizeof(value));
    rest_.remove_prefix(sizeof(value));
    return value;
  }
  template <class Length = std::uint32_t>
  std::string text() {
    const auto length = number<Length>();
    EXPECT_LE(length, rest_.size());
    std::string text(rest_.substr(0, length));
    rest_.remove_prefix(text.size());
    return text;
  }
  /// Texts by their names.
  std::map<std::string, std::string> texts() {
    const std::string pairs = text();
    std::map<std::string, std::string> texts;
    for (McapFields fields(pairs); !fields.rest().empty();) {
      const std::string key = fields.text();
      texts[key] = fields.text();
    }
    return texts;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

struct McapRecord {
  std::uint8_t opcode = 0;
  std::size_t offset = 0;
  std::string content;
};

/// Whole records from `offset` on; what comes after the last whole one is not looked at.
inline std::vector<McapRecord> mcapRecords(std::string_view bytes, std::size_t offset) {
  std::vector<McapRecord> records;
  constexpr std::size_t kHead = 9;
  while (offset + kHead <= bytes.size() && bytes.substr(offset) != kMcapMagic) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[offset + 1], sizeof(length));
    if (length > bytes.size() - offset - kHead) break;
    records.push_back(
        {static_cast<std::uint8_t>(bytes[offset]), offset, std::string(bytes.substr(offset + kHead, length))});
    offset += kHead + length;
  }
  return records;
}

inline std::uint32_t mcapCrc(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Content of a file: that of its whole chunks, as it may be cut off, and that between them.
struct McapContent {
  struct Message {
    std::uint32_t sequence = 0;
    std::uint64_t log_ns = 0, publish_ns = 0;
    std::string data;
  };
  struct Schema {
    std::string name, descriptors;
  };
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::string, std::uint16_t> schema_of;        // by topic
  std::map<std::string, std::vector<Message>> messages;  // by topic
  using Texts = std::map<std::string, std::string>;
  std::map<std::string, Texts> channel_metadata;  // by topic
  std::map<std::string, Texts> metadata;          // by name
  std::size_t chunks = 0;
};

inline void addChunkRecord(const McapRecord& record, std::map<std::uint16_t, std::string>& topics,
                           McapContent& content) {
  McapFields fields(record.content);
  const auto id = fields.number<std::uint16_t>();
  if (record.opcode == 0x03) {
    content.schemas[id].name = fields.text();
    EXPECT_EQ(fields.text(), "protobuf");
    content.schemas[id].descriptors = fields.text();
  } else if (record.opcode == 0x04) {
    const auto schema = fields.number<std::uint16_t>();
    EXPECT_TRUE(content.schemas.contains(schema)) << "a schema comes before its channel";
    topics[id] = fields.text();
    content.schema_of[topics[id]] = schema;
    EXPECT_EQ(fields.text(), "protobuf");
    content.channel_metadata[topics[id]] = fields.texts();
  } else {
    ASSERT_EQ(record.opcode, 0x05);
    ASSERT_TRUE(topics.contains(id)) << "a channel comes before its messages";
    McapContent::Message message{.sequence = fields.number<std::uint32_t>(), .data = {}};
    message.log_ns = fields.number<std::uint64_t>();
    message.publish_ns = fields.number<std::uint64_t>();
    message.data = fields.rest();
    content.messages[topics[id]].push_back(message);
  }
}

inline McapContent readMcap(std::string_view bytes) {
  McapContent content;
  std::map<std::uint16_t, std::string> topics;
  EXPECT_TRUE(bytes.starts_with(kMcapMagic));
  for (const McapRecord& record : mcapRecords(bytes, kMcapMagic.size())) {
    if (record.opcode == 0x0F) break;
    McapFields fields(record.content);
    if (record.opcode == 0x0C) {
      const std::string name = fields.text();
      content.metadata[name] = fields.texts();
    }
    if (record.opcode != 0x06) continue;
    const auto start_ns = fields.number<std::uint64_t>(), end_ns = fields.number<std::uint64_t>();
    EXPECT_LT(end_ns - start_ns, 1'000'000'000U);
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    EXPECT_EQ(fields.text(), "") << "not compressed";
    const std::string records = fields.text<std::uint64_t>();
    EXPECT_EQ(records.size(), size);
    EXPECT_EQ(mcapCrc(records), crc);
    for (const McapRecord& inner : mcapRecords(records, 0)) addChunkRecord(inner, topics, content);
    ++content.chunks;
  }
  return content;
}

}  // namespace motorcade::test
