#include "io/bag/db3_reader.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kTables =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT "
    "NULL, offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB "
    "NOT "
    "NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);";
constexpr const char* kRows =
    "INSERT INTO topics VALUES(5, '/a', 'my/A', 'cdr', ''), (2, '/b', 'my/B', 'cdr', '');"
    "INSERT INTO messages VALUES(1, 5, 30, CAST('third' AS BLOB)), (2, 2, 10, CAST('first' AS BLOB)),"
    "  (3, 5, 20, CAST('second' AS BLOB)), (4, 9, 15, CAST('of no topic' AS BLOB));";

class Db3ReaderTest : public testing::Test {
 protected:
  std::filesystem::path databaseOf(const std::string& commands) const {
    std::filesystem::path file = folder_ / "bag.db3";
    std::filesystem::remove(file);
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, commands.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
    return file;
  }
  static std::vector<std::string> messagesIn(const std::filesystem::path& file,
                                             const std::set<std::string>& topics = {}) {
    std::vector<std::string> messages;
    try {
      Db3Reader reader(file);
      if (!topics.empty()) reader.select(topics);
      while (const auto message = reader.next())
        messages.push_back(reader.topics()[message->topic].name + " " + std::to_string(message->log_ns) + " " +
                           std::string(message->data.begin(), message->data.end()) + ", " + message->place);
    } catch (const InputError& damage) {
      messages.emplace_back(damage.what());
    }
    return messages;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Db3ReaderTest, MessagesComeInTheOrderOfTime) {
  const auto file = databaseOf(std::string(kTables) + kRows);
  EXPECT_THAT(messagesIn(file),
              ElementsAre("/b 10 first, message 2", "/a 20 second, message 3", "/a 30 third, message 1"));
  EXPECT_THAT(messagesIn(file, {"/b"}), ElementsAre("/b 10 first, message 2"));
  const Db3Reader reader(file);
  EXPECT_EQ(reader.topics()[1].type, "my/A");
  EXPECT_EQ(reader.topics()[1].encoding, "cdr");
}

TEST_F(Db3ReaderTest, OtherDatabasesAreNamed) {
  EXPECT_THAT(messagesIn(databaseOf("CREATE TABLE x(a)")).back(), HasSubstr("bag.db3: has no table topics"));
  EXPECT_THAT(messagesIn(databaseOf("CREATE TABLE topics(a); CREATE TABLE messages(a)")).back(),
              HasSubstr("no rosbag2 database"));
  const std::string endless =
      "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) SELECT i AS id FROM n;"
      "CREATE TABLE topics(a)";
  EXPECT_THAT(messagesIn(databaseOf(endless)).back(), HasSubstr("has no table messages"));
  EXPECT_THAT(messagesIn(folder_.write("text.db3", "SQLite format 3 it is not")).back(), HasSubstr("text.db3: "));
  EXPECT_THAT(messagesIn(folder_ / "none.db3").back(), HasSubstr("cannot be opened"));
}

TEST_F(Db3ReaderTest, ADatabaseThatIsCutOffGivesWhatCanBeRead) {
  std::string rows = std::string(kTables) + kRows;
  for (int i = 100; i < 200; ++i)
    rows += "INSERT INTO messages VALUES(" + std::to_string(i) + ", 5, " + std::to_string(i) + ", zeroblob(3000));";
  const auto file = databaseOf(rows);
  const auto whole = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, whole * 2 / 3);
  const auto messages = messagesIn(file);
  EXPECT_GT(messages.size(), 30U);
  EXPECT_THAT(messages.back(), AnyOf(HasSubstr("bag.db3: behind message"), HasSubstr("bag.db3: cannot be read on")));
}

}  // namespace
}  // namespace motorcade
