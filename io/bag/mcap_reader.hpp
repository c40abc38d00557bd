#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/bag/bag_file.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/chunk_decoder.hpp"
#include "io/bag/mcap_format.hpp"

namespace motorcade {

/// Reads an MCAP file record by record, in the order of the file. No more than one chunk is in memory.
class McapReader final : public BagReader {
 public:
  explicit McapReader(const std::filesystem::path& file);

  const std::vector<BagTopic>& topics() const override { return topics_; }
  void select(std::set<std::string> topics) override;
  std::optional<BagMessage> next() override;

 private:
  struct Record {
    mcap::Opcode opcode;
    std::uint64_t position = 0;  // in the file
    std::span<const std::uint8_t> content{};
  };

  std::uint64_t readHead(Record& record);
  Record readRecord();
  void readSummary();
  std::uint64_t summaryStart();
  std::optional<Record> nextInFile();
  std::optional<Record> nextInChunk();
  void openChunk(const Record& record);
  std::optional<BagMessage> take(const Record& record);
  void addSchema(const Record& record);
  void addChannel(const Record& record);
  void addCounts(const Record& record);
  std::optional<BagMessage> messageOf(const Record& record);

  BagFile file_;
  std::vector<BagTopic> topics_;
  std::map<std::uint16_t, std::string> schemas_;   // names by number
  std::map<std::uint16_t, std::size_t> channels_;  // places in `topics_` by number
  std::optional<std::set<std::string>> selected_;  // all where it is empty
  mcap::ByteBuffer record_, unpacked_;
  std::span<const std::uint8_t> chunk_;  // the records that are still to come of it
  std::uint64_t chunk_position_ = 0;     // in the file
  bool ended_ = false;
};

}  // namespace motorcade
