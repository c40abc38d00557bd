#include "io/bag/mcap_reader.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "io/bag/record_fields.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using mcap::Opcode;
using mcap::RecordFields;

constexpr std::size_t kHead_bytes = 9;  // of a record: what it is, and its length

void requireSum(std::span<const std::uint8_t> records, std::uint32_t told, const std::string& place) {
  if (told != 0 && ::crc32_z(0, records.data(), records.size()) != told)
    throw InputError(place + ": the chunk's checksum is wrong: the file is damaged");
}

}  // namespace

McapReader::McapReader(const std::filesystem::path& file) : file_(file) {
  std::array<std::uint8_t, mcap::kMagic.size()> magic{};
  if (file_.size() >= magic.size()) file_.read(magic);
  if (!std::ranges::equal(magic, mcap::kMagic, {}, {}, [](char c) { return static_cast<std::uint8_t>(c); }))
    throw InputError(file_.name() + ": is no MCAP file, it does not begin as one");
  try {
    readSummary();
  } catch (const InputError&) {  // the topics turn up as the file is read
    schemas_.clear(), channels_.clear(), topics_.clear();
  }
  file_.moveTo(magic.size());
}

void McapReader::select(std::set<std::string> topics) { selected_ = std::move(topics); }

/// Returns the length of the record's content.
std::uint64_t McapReader::readHead(Record& record) {
  record.position = file_.position();
  std::array<std::uint8_t, kHead_bytes> head{};
  const std::string place = file_.placeOf(record.position);
  if (file_.left() == 0) throw InputError(place + ": the file ends before it is finished: the recording was cut off");
  if (file_.left() < head.size()) throw InputError(place + ": the file ends within a record: it was cut off");
  file_.read(head);
  RecordFields fields(head, place);
  record.opcode = Opcode{fields.u8()};
  const std::uint64_t length = fields.u64();
  if (length > file_.left())
    throw InputError(place + ": a record of " + std::to_string(length) + " bytes goes beyond the file's end, " +
                     std::to_string(file_.size()) + ": the file was cut off, or is damaged");
  return length;
}

McapReader::Record McapReader::readRecord() {
  Record record{};
  const std::uint64_t length = readHead(record);
  const bool counts = record.opcode == Opcode::kSchema || record.opcode == Opcode::kChannel ||
                      record.opcode == Opcode::kMessage || record.opcode == Opcode::kChunk ||
                      record.opcode == Opcode::kStatistics;
  if (!counts) {
    file_.moveTo(file_.position() + length);
    return record;
  }
  if (length > mcap::kMostRecord_bytes)
    throw InputError(file_.placeOf(record.position) + ": a record has " + std::to_string(length) + " bytes, " +
                     std::to_string(mcap::kMostRecord_bytes) +
                     " at most are read; write the file anew with smaller chunks");
  const auto content = record_.ofSize(static_cast<std::size_t>(length));
  file_.read(content);
  record.content = content;
  return record;
}

/// The summary's beginning by the footer, the last record; 0 where there is none.
std::uint64_t McapReader::summaryStart() {
  constexpr std::size_t kFooter_bytes = kHead_bytes + 20, kEnd_bytes = kFooter_bytes + mcap::kMagic.size();
  if (file_.left() < kEnd_bytes) return 0;
  std::array<std::uint8_t, kFooter_bytes> footer{};
  file_.moveTo(file_.size() - kEnd_bytes);
  file_.read(footer);
  const std::string place = file_.placeOf(file_.size() - kEnd_bytes);
  RecordFields fields(footer, place);
  if (Opcode{fields.u8()} != Opcode::kFooter || fields.u64() != kFooter_bytes - kHead_bytes) return 0;
  const std::uint64_t start = fields.u64();
  return start <= file_.size() - kEnd_bytes ? start : 0;
}

/// Takes the topics from the summary at the file's end, where it has one.
void McapReader::readSummary() {
  const std::uint64_t start = summaryStart();
  if (start == 0) return;
  file_.moveTo(start);
  for (Record record = readRecord(); record.opcode != Opcode::kFooter; record = readRecord()) {
    if (record.opcode == Opcode::kMessage || record.opcode == Opcode::kChunk) return;  // no summary
    take(record);
  }
}

/// The next record outside of chunks; empty at the end of the data.
std::optional<McapReader::Record> McapReader::nextInFile() {
  const Record record = readRecord();
  if (record.opcode == Opcode::kDataEnd || record.opcode == Opcode::kFooter) return std::nullopt;
  return record;
}

/// The next record of the chunk, of which there are some left.
std::optional<McapReader::Record> McapReader::nextInChunk() {
  const std::string place = file_.placeOf(chunk_position_) + ", in the chunk";
  RecordFields fields(chunk_, place);
  Record record{.opcode = Opcode{fields.u8()}, .position = chunk_position_};
  const std::uint64_t length = fields.u64();
  record.content = fields.take(length);
  chunk_ = fields.rest();
  if (record.opcode == Opcode::kChunk) throw InputError(place + ": a chunk lies in a chunk: the file is damaged");
  return record;
}

void McapReader::openChunk(const Record& record) {
  const std::string place = file_.placeOf(record.position);
  RecordFields fields(record.content, place);
  fields.take(2 * sizeof(std::uint64_t));  // the times of its first and last message
  const std::uint64_t size = fields.u64();
  const std::uint32_t sum = fields.u32();
  const std::string compression = fields.text();
  const std::uint64_t length = fields.u64();
  chunk_ = mcap::chunkRecords(compression, fields.take(length), size, unpacked_, place);
  chunk_position_ = record.position;
  requireSum(chunk_, sum, place);
}

std::optional<BagMessage> McapReader::next() {
  while (!ended_ && !stopped()) {
    const auto record = chunk_.empty() ? nextInFile() : nextInChunk();
    if (!record)
      ended_ = true;
    else if (record->opcode == Opcode::kChunk)
      openChunk(*record);
    else if (auto message = take(*record))
      return message;
  }
  return std::nullopt;
}

/// Processes a record; returns the message if it is a wanted one.
std::optional<BagMessage> McapReader::take(const Record& record) {
  switch (record.opcode) {
    case Opcode::kSchema:
      addSchema(record);
      break;
    case Opcode::kChannel:
      addChannel(record);
      break;
    case Opcode::kStatistics:
      addCounts(record);
      break;
    case Opcode::kMessage:
      return messageOf(record);
    default:
      break;  // indexes, attachments, and what others added
  }
  return std::nullopt;
}

void McapReader::addSchema(const Record& record) {
  const std::string place = file_.placeOf(record.position);
  RecordFields fields(record.content, place);
  const std::uint16_t number = fields.u16();
  schemas_[number] = fields.text();
}

/// Adds a channel. It may come again, in each chunk and in the summary; several channels may have one topic.
void McapReader::addChannel(const Record& record) {
  const std::string place = file_.placeOf(record.position);
  RecordFields fields(record.content, place);
  const std::uint16_t number = fields.u16(), schema = fields.u16();
  BagTopic topic{.name = fields.text()};
  topic.encoding = fields.text();
  if (const auto found = schemas_.find(schema); found != schemas_.end()) topic.type = found->second;
  if (channels_.contains(number)) return;
  const auto known = std::ranges::find_if(topics_, [&](const BagTopic& other) {
    return other.name == topic.name && other.type == topic.type && other.encoding == topic.encoding;
  });
  channels_[number] = static_cast<std::size_t>(known - topics_.begin());
  if (known == topics_.end()) topics_.push_back(std::move(topic));
}

void McapReader::addCounts(const Record& record) {
  const std::string place = file_.placeOf(record.position);
  RecordFields fields(record.content, place);
  constexpr std::size_t kBefore_bytes = 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8;  // counts of all, first and last time
  constexpr std::size_t kEntry_bytes = 2 + 8;
  fields.take(kBefore_bytes);
  for (std::uint32_t left = fields.u32(); left >= kEntry_bytes; left -= kEntry_bytes) {
    const std::uint16_t channel = fields.u16();
    const std::uint64_t count = fields.u64();
    if (const auto found = channels_.find(channel); found != channels_.end()) topics_[found->second].messages += count;
  }
}

std::optional<BagMessage> McapReader::messageOf(const Record& record) {
  const std::string place = file_.placeOf(record.position);
  RecordFields fields(record.content, place);
  const std::uint16_t number = fields.u16();
  const auto channel = channels_.find(number);
  if (channel == channels_.end())
    throw InputError(place + ": a message is of channel " + std::to_string(number) +
                     ", which was not told of: the file is damaged");
  if (selected_ && !selected_->contains(topics_[channel->second].name)) return std::nullopt;
  fields.u32();  // counts the channel's messages
  BagMessage message{.topic = channel->second, .log_ns = static_cast<std::int64_t>(fields.u64())};
  fields.u64();  // when it was sent
  message.data = fields.rest();
  message.place = "byte " + std::to_string(record.position);
  return message;
}

}  // namespace motorcade
