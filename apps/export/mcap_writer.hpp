#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "apps/export/mcap_record.hpp"
#include "core/timestamp.hpp"
#include "io/files/output_file.hpp"

namespace motorcade::mcap {

using SchemaId = std::uint16_t;
using ChannelId = std::uint16_t;

/// Writes an MCAP file of Protobuf messages, with an index and a summary at its end. Messages gather in a chunk, which
/// is written at once when it spans a second or four megabytes. A file that was cut off anywhere is therefore readable
/// up to its last whole chunk. Chunks are not compressed, as images are already. Every failure is an OutputError naming
/// the file.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& file);

  /// `descriptors` is a serialized FileDescriptorSet with all that the message type `name` needs.
  SchemaId addSchema(std::string_view name, std::string_view descriptors);
  ChannelId addChannel(SchemaId schema, std::string_view topic, const Texts& metadata = {});
  /// Facts about the whole file, written at once.
  void writeMetadata(std::string_view name, const Texts& metadata);
  /// Times before zero, which the format cannot hold, become zero.
  void write(ChannelId channel, Timestamp time, std::string_view message);
  /// Writes the last chunk, index and summary. Without it the file is like one that was cut off.
  void close();

  std::uint64_t bytes() const { return offset_; }

 private:
  struct TimeSpan {
    std::uint64_t start_ns = 0, end_ns = 0;  // zero where there is no message
    bool empty = true;
    void add(std::uint64_t time_ns);
  };
  struct ChunkPlace {
    TimeSpan span;
    std::uint64_t offset = 0, length = 0, records = 0;  // of the record, and of what is in it [bytes]
    std::map<ChannelId, std::uint64_t> indexes;         // where the message index of each channel is
    std::uint64_t indexes_length = 0;
  };
  struct Message {
    std::uint64_t time_ns, offset;  // in its chunk
  };

  void endChunk();
  void endData();
  void writeSummary();
  std::string chunkIndexes() const;
  std::string statistics() const;
  void put(std::string_view bytes);

  OutputFile file_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;           // of all that was written
  std::string schemas_, channels_;  // records, which come again in the summary
  std::uint16_t schema_count_ = 0;
  std::string metadata_indexes_;  // records of the summary
  std::uint32_t metadata_count_ = 0;
  std::map<ChannelId, std::uint64_t> messages_;  // per channel
  std::string chunk_;                            // records of the chunk that is gathering
  TimeSpan chunk_span_, span_;
  std::map<ChannelId, std::vector<Message>> chunk_messages_;
  std::vector<ChunkPlace> chunks_;
};

}  // namespace motorcade::mcap
