#include "apps/export/mcap_writer.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/apps/export/mcap_reading.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::McapContent;
using test::McapFields;
using test::McapRecord;

class McapWriter : public testing::Test {
 protected:
  /// Two topics, ten messages a second on the first for 3.5 s, one in five on the second.
  void writeFile(bool closed = true) {
    mcap::Writer writer(folder_ / "file.mcap");
    const auto schema = writer.addSchema("test.Message", "descriptors");
    const auto fast = writer.addChannel(schema, "/fast"), slow = writer.addChannel(schema, "/slow");
    for (int i = 0; i < 35; ++i) {
      const Timestamp stamp{2'000'000'000 + std::int64_t{100'000'000} * i};
      writer.write(fast, stamp, "message " + std::to_string(i));
      if (i % 5 == 0) writer.write(slow, stamp, std::string("with\0zero", 9));
    }
    if (closed) writer.close();
  }
  std::string content() { return folder_.read("file.mcap"); }

  test::TemporaryFolder folder_;
};

TEST_F(McapWriter, WritesWhatAReaderFromTheStartFinds) {
  writeFile();
  const McapContent found = test::readMcap(content());
  EXPECT_EQ(found.chunks, 4U);
  EXPECT_EQ(found.schemas.at(1).name, "test.Message");
  EXPECT_EQ(found.schemas.at(1).descriptors, "descriptors");
  const auto& fast = found.messages.at("/fast");
  ASSERT_EQ(fast.size(), 35U);
  for (std::uint64_t i = 0; i < fast.size(); ++i) {
    EXPECT_EQ(fast[i].data, "message " + std::to_string(i));
    EXPECT_EQ(fast[i].sequence, i);
    EXPECT_EQ(fast[i].log_ns, 2'000'000'000U + 100'000'000U * i);
    EXPECT_EQ(fast[i].publish_ns, fast[i].log_ns);
  }
  EXPECT_EQ(found.messages.at("/slow").size(), 7U);
  EXPECT_EQ(found.messages.at("/slow")[1].data, std::string("with\0zero", 9));
}

TEST_F(McapWriter, TheSummaryLeadsToEveryMessage) {
  writeFile();
  const std::string bytes = content();
  ASSERT_TRUE(bytes.ends_with(test::kMcapMagic));
  constexpr std::size_t kFooter = 9 + 20;
  const std::size_t footer = bytes.size() - test::kMcapMagic.size() - kFooter;
  ASSERT_EQ(bytes[footer], 0x02);
  McapFields fields(std::string_view(bytes).substr(footer + 9));
  const auto start = fields.number<std::uint64_t>(), offsets = fields.number<std::uint64_t>();
  EXPECT_EQ(fields.number<std::uint32_t>(),
            test::mcapCrc(std::string_view(bytes).substr(start, footer + kFooter - 4 - start)));
  std::uint64_t messages = 0;
  for (const McapRecord& record : test::mcapRecords(std::string_view(bytes).substr(0, offsets), start)) {
    if (record.opcode != 0x08) continue;
    McapFields index(record.content);
    index.number<std::uint64_t>();
    index.number<std::uint64_t>();
    const auto chunk = index.number<std::uint64_t>();
    index.number<std::uint64_t>();
    ASSERT_EQ(bytes[chunk], 0x06);
    // Of the chunk: head, two times, size, sum, name of the compression, size.
    const std::size_t records = chunk + 9 + 8 + 8 + 8 + 4 + 4 + 8;
    const std::string channels = index.text();
    for (McapFields channel(channels); !channel.rest().empty();) {
      const auto id = channel.number<std::uint16_t>();
      const auto place = channel.number<std::uint64_t>();
      ASSERT_EQ(bytes[place], 0x07);
      McapFields message_index(std::string_view(bytes).substr(place + 9));
      EXPECT_EQ(message_index.number<std::uint16_t>(), id);
      const std::string entries = message_index.text();
      for (McapFields entry(entries); !entry.rest().empty(); ++messages) {
        const auto time_ns = entry.number<std::uint64_t>(), offset = entry.number<std::uint64_t>();
        ASSERT_EQ(bytes[records + offset], 0x05);
        McapFields message(std::string_view(bytes).substr(records + offset + 9));
        EXPECT_EQ(message.number<std::uint16_t>(), id);
        message.number<std::uint32_t>();
        EXPECT_EQ(message.number<std::uint64_t>(), time_ns);
      }
    }
  }
  EXPECT_EQ(messages, 42U);
}

TEST_F(McapWriter, SumsUpTheDataSectionAndCountsItsMessages) {
  writeFile();
  const std::string bytes = content();
  bool ended = false, counted = false;
  for (const McapRecord& record : test::mcapRecords(bytes, test::kMcapMagic.size())) {
    McapFields fields(record.content);
    if (record.opcode == 0x0F) {
      ended = true;
      EXPECT_EQ(fields.number<std::uint32_t>(), test::mcapCrc(std::string_view(bytes).substr(0, record.offset)));
    } else if (record.opcode == 0x0B) {
      counted = true;
      EXPECT_EQ(fields.number<std::uint64_t>(), 42U);
      EXPECT_EQ(fields.number<std::uint16_t>(), 1U) << "schemas";
      EXPECT_EQ(fields.number<std::uint32_t>(), 2U) << "channels";
    }
  }
  EXPECT_TRUE(ended && counted);
}

TEST_F(McapWriter, TellsFactsOfTheFileAndOfItsChannels) {
  mcap::Writer writer(folder_ / "file.mcap");
  const auto channel = writer.addChannel(writer.addSchema("test.Message", ""), "/topic", {{"made of", "images"}});
  writer.writeMetadata("first", {{"a", "1"}, {"b", ""}});
  writer.write(channel, {5}, "message");
  writer.writeMetadata("second", {});
  writer.close();
  const std::string bytes = content();
  const McapContent found = test::readMcap(bytes);
  EXPECT_THAT(found.channel_metadata.at("/topic"), testing::ElementsAre(testing::Pair("made of", "images")));
  EXPECT_THAT(found.metadata.at("first"), testing::ElementsAre(testing::Pair("a", "1"), testing::Pair("b", "")));
  EXPECT_THAT(found.metadata.at("second"), testing::IsEmpty());
  std::vector<std::string> indexed;
  for (const McapRecord& record : test::mcapRecords(bytes, test::kMcapMagic.size())) {
    McapFields fields(record.content);
    if (record.opcode == 0x0D) {
      const auto offset = fields.number<std::uint64_t>(), length = fields.number<std::uint64_t>();
      const auto records = test::mcapRecords(std::string_view(bytes).substr(0, offset + length), offset);
      ASSERT_EQ(records.size(), 1U);
      EXPECT_EQ(records[0].opcode, 0x0C);
      indexed.push_back(fields.text());
      EXPECT_EQ(McapFields(records[0].content).text(), indexed.back());
    } else if (record.opcode == 0x0B) {
      EXPECT_EQ(McapFields(std::string_view(record.content).substr(8 + 2 + 4 + 4)).number<std::uint32_t>(), 2U);
    }
  }
  EXPECT_THAT(indexed, testing::ElementsAre("first", "second"));
}

TEST_F(McapWriter, AFileThatIsCutOffAnywhereHasItsWholeChunks) {
  writeFile();
  const std::string bytes = content();
  std::vector<std::size_t> ends;  // of the chunks
  for (const McapRecord& record : test::mcapRecords(bytes, test::kMcapMagic.size()))
    if (record.opcode == 0x06) ends.push_back(record.offset + 9 + record.content.size());
  ASSERT_EQ(ends.size(), 4U);
  for (std::size_t length = test::kMcapMagic.size(); length < ends.back(); length += 7) {
    const auto whole = std::ranges::count_if(ends, [&](std::size_t end) { return end <= length; });
    EXPECT_EQ(test::readMcap(std::string_view(bytes).substr(0, length)).chunks, static_cast<std::size_t>(whole));
  }
}

TEST_F(McapWriter, LosesAtMostASecondWhenItIsNotClosed) {
  writeFile(false);
  EXPECT_EQ(test::readMcap(content()).messages.at("/fast").size(), 30U);
}

TEST_F(McapWriter, TellsWhichFileCannotBeWritten) {
  EXPECT_THAT(test::messageOf<OutputError>([&] { mcap::Writer writer(folder_ / "not there" / "file.mcap"); }),
              testing::HasSubstr("not there/file.mcap"));
}

}  // namespace
}  // namespace motorcade
