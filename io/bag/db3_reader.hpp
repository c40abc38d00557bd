#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/bag/bag_reader.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace motorcade {

/// Reads the database of rosbag2's first storage, in the order of time. No more than one message is in memory.
class Db3Reader final : public BagReader {
 public:
  explicit Db3Reader(const std::filesystem::path& file);
  ~Db3Reader() override;
  Db3Reader(const Db3Reader&) = delete;
  Db3Reader& operator=(const Db3Reader&) = delete;

  const std::vector<BagTopic>& topics() const override { return topics_; }
  void select(std::set<std::string> topics) override { selected_ = std::move(topics); }
  std::optional<BagMessage> next() override;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  void open();
  void requireTable(const std::string& table);
  void readTopics();
  Statement prepare(const std::string& text);
  bool step(sqlite3_stmt* statement);
  std::optional<BagMessage> messageOf(std::int64_t number, std::int64_t log_ns, std::size_t topic);
  [[noreturn]] void fail(const std::string& what) const;

  std::string name_;
  std::unique_ptr<sqlite3, Close> database_;
  std::vector<BagTopic> topics_;
  std::map<std::int64_t, std::size_t> places_;     // in `topics_`, by the database's number
  std::optional<std::set<std::string>> selected_;  // all where it is empty
  std::int64_t last_number_ = 0;                   // of the message before, for messages to the user
  Statement order_, data_;                         // numbers in the order of time; the message of a number
};

}  // namespace motorcade
