#include "io/bag/mcap_reader.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/mcap_text.hpp"

namespace motorcade {
namespace {

using test::McapText;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string zstdOf(const std::string& text) {
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 3));
  return packed;
}

std::string lz4Of(const std::string& text) {
  std::string packed(LZ4F_compressFrameBound(text.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), text.data(), text.size(), nullptr));
  return packed;
}

std::uint32_t sumOf(const std::string& text) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
}

/// Two topics with a message each.
std::string twoMessages() {
  return McapText()
      .topic(1, "/a", "my/A")
      .topic(2, "/b", "my/B")
      .message(1, 10, "first")
      .message(2, 20, "second")
      .text();
}

class McapReaderTest : public testing::Test {
 protected:
  /// The messages of a file, and the error that ends them if there is one.
  std::vector<std::string> messagesIn(const std::string& content, const std::set<std::string>& topics = {}) {
    std::vector<std::string> messages;
    try {
      McapReader reader(folder_.write("bag.mcap", content));
      if (!topics.empty()) reader.select(topics);
      while (const auto message = reader.next())
        messages.push_back(reader.topics()[message->topic].name + " " + std::to_string(message->log_ns) + " " +
                           std::string(message->data.begin(), message->data.end()));
    } catch (const InputError& damage) {
      messages.emplace_back(damage.what());
    }
    return messages;
  }
  std::string damageOf(const std::string& content) { return messagesIn(content).back(); }

  test::TemporaryFolder folder_;
};

TEST_F(McapReaderTest, MessagesComeFromChunksOfEveryCompressionAndFromOutside) {
  const std::string records = twoMessages();
  for (const auto& [name, stored] :
       {std::pair<std::string, std::string>{"", records}, {"zstd", zstdOf(records)}, {"lz4", lz4Of(records)}}) {
    const std::string file = McapText()
                                 .magic()
                                 .header()
                                 .chunk(name, stored, records.size(), sumOf(records))
                                 .message(2, 30, "outside")
                                 .end()
                                 .text();
    EXPECT_THAT(messagesIn(file), ElementsAre("/a 10 first", "/b 20 second", "/b 30 outside")) << name;
    EXPECT_THAT(messagesIn(file, {"/a"}), ElementsAre("/a 10 first")) << name;
  }
}

TEST_F(McapReaderTest, TheSummaryTellsTheTopicsBeforeTheFirstMessage) {
  McapText file;
  file.magic().header().plain(twoMessages()).record(0x0F, McapText().u32(0));
  const std::size_t summary = file.text().size();
  file.topic(1, "/a", "my/A").topic(2, "/b", "my/B");
  file.record(
      0x0B, McapText().u64(2).u16(2).u32(2).u32(0).u32(0).u32(0).u64(10).u64(20).u32(20).u16(1).u64(1).u16(2).u64(144));
  file.record(0x02, McapText().u64(summary).u64(0).u32(0)).magic();
  McapReader reader(folder_.write("bag.mcap", file.text()));
  ASSERT_EQ(reader.topics().size(), 2U);
  EXPECT_EQ(reader.topics()[1].name, "/b");
  EXPECT_EQ(reader.topics()[1].type, "my/B");
  EXPECT_EQ(reader.topics()[1].encoding, "cdr");
  EXPECT_EQ(reader.topics()[1].messages, 144U);
  EXPECT_THAT(messagesIn(file.text()), ElementsAre("/a 10 first", "/b 20 second"));
}

TEST_F(McapReaderTest, AFileThatIsCutOffAnywhereGivesWhatCameBefore) {
  const std::string records = twoMessages();
  const std::string whole = McapText()
                                .magic()
                                .header()
                                .chunk("zstd", zstdOf(records), records.size())
                                .chunk("", twoMessages(), records.size())
                                .text();
  const std::size_t first = McapText().magic().header().chunk("zstd", zstdOf(records), records.size()).text().size();
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto messages = messagesIn(whole.substr(0, size));
    EXPECT_EQ(messages.size(), size < first ? 1U : size < whole.size() ? 3U : 5U) << size;
    EXPECT_THAT(messages.back(),
                AllOf(HasSubstr("bag.mcap: "), size < 8 ? HasSubstr("no MCAP file") : HasSubstr("byte ")))
        << size;
  }
  EXPECT_THAT(damageOf(whole),
              HasSubstr("byte " + std::to_string(whole.size()) + ": the file ends before it is finished"));
}

TEST_F(McapReaderTest, DamageIsNamedWithItsPlace) {
  const std::string records = twoMessages(), start = McapText().magic().header().text();
  const std::string place = "byte " + std::to_string(start.size());
  const auto damage = [&](const McapText& rest) { return damageOf(start + rest.text()); };
  EXPECT_THAT(damage(McapText().chunk("", records, records.size(), 5)), AllOf(HasSubstr(place), HasSubstr("checksum")));
  EXPECT_THAT(damage(McapText().chunk("zstd", records, records.size())), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(damage(McapText().chunk("lz4", records, records.size())), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(damage(McapText().chunk("zstd", zstdOf(records), records.size() + 1)), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(damage(McapText().chunk("lz4", lz4Of(records), records.size() - 1)), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(damage(McapText().chunk("lz4", lz4Of(records), records.size() + 1)), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(damage(McapText().chunk("brotli", records, records.size())), HasSubstr("'brotli' is not read"));
  EXPECT_THAT(damage(McapText().message(9, 0, "x")), HasSubstr("channel 9"));
  EXPECT_THAT(damage(McapText().record(0x04, McapText().u16(1).u16(1).u32(5'000'000'000).plain("/a"))),
              HasSubstr("longer than its record"));
  EXPECT_THAT(damage(McapText().record(0x03, McapText().u16(1).word(std::string(2000, 'x')))),
              HasSubstr("a name has 2000 bytes"));
  const std::string inner = McapText().chunk("", records, records.size()).text();
  EXPECT_THAT(damage(McapText().chunk("", inner, inner.size())), HasSubstr("a chunk lies in a chunk"));
}

TEST_F(McapReaderTest, LengthsBeyondTheFileOrTheMemoryAreRefused) {
  const std::string start = McapText().magic().header().text(), records = twoMessages();
  EXPECT_THAT(damageOf(start + McapText().u8(0x05).u64(UINT64_MAX).text()), HasSubstr("goes beyond the file's end"));
  EXPECT_THAT(damageOf(start + McapText().chunk("zstd", zstdOf(records), std::uint64_t{1} << 40).text()),
              HasSubstr("1099511627776 bytes when it is unpacked"));
  const auto file = folder_.write("bag.mcap", start + McapText().u8(0x06).u64(std::uint64_t{1} << 30).text());
  std::filesystem::resize_file(file, start.size() + 9 + (std::uint64_t{1} << 30));  // a hole, which takes no room
  McapReader reader(file);
  EXPECT_THROW(reader.next(), InputError);
}

}  // namespace
}  // namespace motorcade
