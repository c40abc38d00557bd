#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace motorcade {

struct BagTopic {
  std::string name{}, type{};
  std::string encoding{};      // of its messages: cdr, ros1, ...
  std::uint64_t messages = 0;  // 0 where the bag does not tell before it was read
};

/// A message as it stands in the bag; its bytes are there until the next one is read.
struct BagMessage {
  std::size_t topic = 0;  // place in `topics()`
  std::int64_t log_ns = 0;
  std::span<const std::uint8_t> data{};
  std::string place{};  // in the bag, as `byte 1234`
};

/// A recording of many topics' messages, read from its beginning to its end. One thread reads, any thread may stop.
class BagReader {
 public:
  virtual ~BagReader() = default;

  /// The topics known so far: those that the file lists, or whose messages were read. Their indices do not change.
  virtual const std::vector<BagTopic>& topics() const = 0;
  /// Leaves out the messages of all other topics, from now on.
  virtual void select(std::set<std::string> topics) = 0;
  /// The next message; empty after the last one, and after `stop`. Throws InputError with the file's name and the
  /// position where the file is damaged, or ends before it is finished; nothing can be read afterwards.
  virtual std::optional<BagMessage> next() = 0;

  void stop() { stopped_.store(true); }
  bool stopped() const { return stopped_.load(); }

 private:
  std::atomic<bool> stopped_{false};
};

/// True for files and folders that are bags by their name or their first bytes.
bool isBag(const std::filesystem::path& path);

/// Opens an MCAP file, a rosbag2 database (`.db3`), or a rosbag2 folder with one of them. Throws InputError.
std::unique_ptr<BagReader> openBag(const std::filesystem::path& path);

}  // namespace motorcade
