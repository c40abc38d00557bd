#include "io/bag/db3_reader.hpp"

#include <utility>

#include <sqlite3.h>

#include "io/bag/chunk_decoder.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

std::string columnText(sqlite3_stmt* row, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  return text ? std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(row, column))) : std::string();
}

}  // namespace

void Db3Reader::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void Db3Reader::Close::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Db3Reader::Db3Reader(const std::filesystem::path& file) : name_(file.string()) {
  open();
  requireTable("topics");
  requireTable("messages");
  readTopics();
  // Rows are read in the order of time. Without rosbag2's index, SQLite sorts these few numbers, in a temporary file if
  // need be.
  order_ = prepare("SELECT rowid, topic_id, timestamp FROM messages ORDER BY timestamp, rowid");
  data_ = prepare("SELECT data FROM messages WHERE rowid = ?");
}

Db3Reader::~Db3Reader() = default;

void Db3Reader::fail(const std::string& what) const {
  throw InputError(name_ + ": " + (last_number_ > 0 ? "behind message " + std::to_string(last_number_) + ": " : "") +
                   what);
}

/// Opens the database so that it can only be read, as it may come from an unknown source. One that was cut off is
/// refused as a whole, unless its schema may be written, which nothing here does.
void Db3Reader::open() {
  sqlite3* database = nullptr;
  const int outcome = sqlite3_open_v2(name_.c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
  database_.reset(database);
  if (outcome != SQLITE_OK) fail(std::string("cannot be opened: ") + sqlite3_errstr(outcome));
  sqlite3_db_config(database, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(mcap::kMostRecord_bytes));
}

Db3Reader::Statement Db3Reader::prepare(const std::string& text) {
  sqlite3_stmt* statement = nullptr;
  const int outcome = sqlite3_prepare_v2(database_.get(), text.c_str(), -1, &statement, nullptr);
  if (outcome != SQLITE_OK)
    fail("is no rosbag2 database, or is damaged: " + printable(sqlite3_errmsg(database_.get()), 120));
  return Statement(statement);
}

/// False where there is no further row.
bool Db3Reader::step(sqlite3_stmt* statement) {
  const int outcome = sqlite3_step(statement);
  if (outcome != SQLITE_ROW && outcome != SQLITE_DONE)
    fail(std::string("cannot be read on: ") + sqlite3_errstr(outcome));
  return outcome == SQLITE_ROW;
}

/// Requires a table, as a view of that name could compute without end.
void Db3Reader::requireTable(const std::string& table) {
  const Statement kind = prepare("SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = '" + table + "'");
  if (!step(kind.get())) fail("has no table " + table + ": it is no rosbag2 database");
}

void Db3Reader::readTopics() {
  constexpr std::size_t kMost = 65536, kLongest = 1024;
  const Statement rows = prepare("SELECT id, name, type, serialization_format FROM topics");
  while (step(rows.get())) {
    if (topics_.size() == kMost) fail("has more than " + std::to_string(kMost) + " topics");
    for (const int column : {1, 2, 3})
      if (sqlite3_column_bytes(rows.get(), column) > static_cast<int>(kLongest))
        fail("has a topic with an endless name");
    places_[sqlite3_column_int64(rows.get(), 0)] = topics_.size();
    topics_.push_back({columnText(rows.get(), 1), columnText(rows.get(), 2), columnText(rows.get(), 3)});
  }
}

std::optional<BagMessage> Db3Reader::next() {
  while (!stopped() && step(order_.get())) {
    const auto place = places_.find(sqlite3_column_int64(order_.get(), 1));
    if (place == places_.end() || (selected_ && !selected_->contains(topics_[place->second].name))) continue;
    const std::int64_t number = sqlite3_column_int64(order_.get(), 0), log_ns = sqlite3_column_int64(order_.get(), 2);
    if (auto message = messageOf(number, log_ns, place->second)) return message;
  }
  return std::nullopt;
}

std::optional<BagMessage> Db3Reader::messageOf(std::int64_t number, std::int64_t log_ns, std::size_t topic) {
  sqlite3_reset(data_.get());
  sqlite3_bind_int64(data_.get(), 1, number);
  if (!step(data_.get())) return std::nullopt;
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(data_.get(), 0));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(data_.get(), 0));
  last_number_ = number;
  return BagMessage{.topic = topic,
                    .log_ns = log_ns,
                    .data = {bytes, bytes ? size : 0},
                    .place = "message " + std::to_string(number)};
}

}  // namespace motorcade
