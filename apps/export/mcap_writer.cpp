#include "apps/export/mcap_writer.hpp"

#include <algorithm>

namespace motorcade::mcap {
namespace {

constexpr std::uint64_t kChunk_ns = 1'000'000'000;
constexpr std::size_t kChunk_bytes = std::size_t{4} << 20;
constexpr std::string_view kUncompressed;

/// Appends the offset of one group of records in the summary, or nothing for an empty group.
void appendSummaryOffset(std::string& offsets, Opcode opcode, std::uint64_t start, std::uint64_t length) {
  if (length == 0) return;
  append(offsets, Opcode::kSummaryOffset, Fields().u8(static_cast<std::uint8_t>(opcode)).u64(start).u64(length));
}

}  // namespace

void Writer::TimeSpan::add(std::uint64_t time_ns) {
  start_ns = empty ? time_ns : std::min(start_ns, time_ns);
  end_ns = std::max(end_ns, time_ns);
  empty = false;
}

Writer::Writer(const std::filesystem::path& file) : file_(file) {
  std::string start(kMagic);
  append(start, Opcode::kHeader, Fields().text("").text("motorcade"));
  put(start);
}

SchemaId Writer::addSchema(std::string_view name, std::string_view descriptors) {
  const SchemaId id = ++schema_count_;  // none is zero
  std::string record;
  append(record, Opcode::kSchema, Fields().u16(id).text(name).text("protobuf").text(descriptors));
  schemas_ += record;
  chunk_ += record;
  return id;
}

ChannelId Writer::addChannel(SchemaId schema, std::string_view topic, const Texts& metadata) {
  const auto id = static_cast<ChannelId>(messages_.size() + 1);
  messages_[id] = 0;
  std::string record;
  append(record, Opcode::kChannel, Fields().u16(id).u16(schema).text(topic).text("protobuf").map(metadata));
  channels_ += record;
  chunk_ += record;
  return id;
}

void Writer::writeMetadata(std::string_view name, const Texts& metadata) {
  std::string record;
  const std::uint64_t length = append(record, Opcode::kMetadata, Fields().text(name).map(metadata));
  append(metadata_indexes_, Opcode::kMetadataIndex, Fields().u64(offset_).u64(length).text(name));
  ++metadata_count_;
  put(record);
}

void Writer::write(ChannelId channel, Timestamp time, std::string_view message) {
  const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(time.ns, 0));
  const bool later = !chunk_span_.empty && time_ns >= chunk_span_.start_ns + kChunk_ns;
  if (later || chunk_.size() >= kChunk_bytes) endChunk();
  chunk_messages_[channel].push_back({time_ns, chunk_.size()});
  const auto sequence = static_cast<std::uint32_t>(messages_[channel]++);
  append(chunk_, Opcode::kMessage, Fields().u16(channel).u32(sequence).u64(time_ns).u64(time_ns).bytes(message));
  chunk_span_.add(time_ns);
  span_.add(time_ns);
}

void Writer::endChunk() {
  if (chunk_.empty()) return;
  ChunkPlace place{.span = chunk_span_, .offset = offset_, .records = chunk_.size(), .indexes = {}};
  std::string records;
  place.length = append(records, Opcode::kChunk,
                        Fields()
                            .u64(chunk_span_.start_ns)
                            .u64(chunk_span_.end_ns)
                            .u64(chunk_.size())
                            .u32(crc32(chunk_))
                            .text(kUncompressed)
                            .u64(chunk_.size())
                            .bytes(chunk_));
  for (const auto& [channel, messages] : chunk_messages_) {
    place.indexes[channel] = offset_ + records.size();
    Fields index, entries;
    for (const Message& message : messages) entries.u64(message.time_ns).u64(message.offset);
    place.indexes_length += append(records, Opcode::kMessageIndex, index.u16(channel).text(entries.content()));
  }
  put(records);
  chunks_.push_back(std::move(place));
  chunk_.clear();
  chunk_messages_.clear();
  chunk_span_ = {};
}

void Writer::close() {
  endChunk();
  endData();
  writeSummary();
  file_.close();
}

void Writer::endData() {
  std::string record;
  append(record, Opcode::kDataEnd, Fields().u32(crc_));
  put(record);
}

std::string Writer::chunkIndexes() const {
  std::string records;
  for (const ChunkPlace& chunk : chunks_)
    append(records, Opcode::kChunkIndex,
           Fields()
               .u64(chunk.span.start_ns)
               .u64(chunk.span.end_ns)
               .u64(chunk.offset)
               .u64(chunk.length)
               .map(chunk.indexes)
               .u64(chunk.indexes_length)
               .text(kUncompressed)
               .u64(chunk.records)
               .u64(chunk.records));
  return records;
}

std::string Writer::statistics() const {
  std::uint64_t count = 0;
  for (const auto& [channel, messages] : messages_) count += messages;
  std::string record;
  append(record, Opcode::kStatistics,
         Fields()
             .u64(count)
             .u16(schema_count_)
             .u32(static_cast<std::uint32_t>(messages_.size()))
             .u32(0)  // attachments
             .u32(metadata_count_)
             .u32(static_cast<std::uint32_t>(chunks_.size()))
             .u64(span_.start_ns)
             .u64(span_.end_ns)
             .map(messages_));
  return record;
}

void Writer::writeSummary() {
  const std::uint64_t start = offset_;
  std::string summary, offsets;
  const auto addGroup = [&](Opcode opcode, const std::string& records) {
    appendSummaryOffset(offsets, opcode, start + summary.size(), records.size());
    summary += records;
  };
  addGroup(Opcode::kSchema, schemas_);
  addGroup(Opcode::kChannel, channels_);
  addGroup(Opcode::kStatistics, statistics());
  addGroup(Opcode::kChunkIndex, chunkIndexes());
  addGroup(Opcode::kMetadataIndex, metadata_indexes_);
  const std::uint64_t offsets_start = start + summary.size();
  summary += offsets;
  // The checksum goes up to its own field, over the footer's header and the two offsets, too.
  constexpr std::uint64_t kFooter_bytes = 20;
  Fields footer;
  footer.u8(static_cast<std::uint8_t>(Opcode::kFooter)).u64(kFooter_bytes).u64(start).u64(offsets_start);
  summary += footer.content();
  summary += Fields().u32(crc32(summary)).content();
  summary += kMagic;
  put(summary);
}

void Writer::put(std::string_view bytes) {
  file_.write(bytes);
  offset_ += bytes.size();
  crc_ = crc32(bytes, crc_);
}

}  // namespace motorcade::mcap
