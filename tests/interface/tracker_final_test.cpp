#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/interface/tracked_drive.hpp"

/// Tests the frames that leave the smoothing window, which have a callback of their own.
namespace motorcade {
namespace {

using testing::HasSubstr;

struct FinalsAndResults {
  std::vector<Result> finals, results;
};

FinalsAndResults finalsOf(const DriveInMemory& drive, const Tracker::Options& options) {
  FinalsAndResults both;
  Tracker tracker(drive.camera, options);
  tracker.on_final([&](Result final) { both.finals.push_back(std::move(final)); });
  std::jthread producer([&] {
    for (std::size_t i = 0; i < drive.frames.size(); ++i) tracker.push(drive.pair(i));
    tracker.close();
  });
  both.results = rest(tracker);
  return both;
}

std::vector<std::string> fieldsOf(const std::string& line, char separator) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  return fields;
}

/// Rows of a table, by the names of its columns.
std::vector<std::map<std::string, std::string>> tableOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  const auto names = fieldsOf(line, ',');
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(stream, line)) {
    const auto fields = fieldsOf(line, ',');
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size() && i < fields.size(); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

/// Results of `motorcade run` on the small drive, in a folder that goes with the test.
class Finals : public testing::Test {
 protected:
  void SetUp() override {
    const std::string command = std::string(MOTORCADE_PROGRAM) + " run --quiet " + MOTORCADE_SMALL_SEQUENCE +
                                " --out " + folder_.string() + " > /dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("finals_" + std::to_string(::getpid()));
  const DriveInMemory drive_ = readDrive(MOTORCADE_SMALL_SEQUENCE);
};

TEST_F(Finals, AreTheCameraOfTheProgramsFinalFiles) {
  const auto [finals, results] = finalsOf(drive_, replay());
  ASSERT_EQ(finals.size(), drive_.frames.size());
  std::ifstream file(folder_ / "camera_final.txt");
  bool online_differs = false;
  for (std::size_t i = 0; i < finals.size(); ++i) {
    EXPECT_EQ(finals[i].frame, static_cast<std::int64_t>(i));
    EXPECT_EQ(finals[i].stamp_ns, drive_.frames[i].stamp_ns);
    EXPECT_EQ(finals[i].status, results[i].status);
    for (const double value : finals[i].T_world_cam) {
      double written = 0;
      file >> written;
      EXPECT_NEAR(value, written, 1e-8);
    }
    ASSERT_TRUE(finals[i].pose_covariance);
    online_differs = online_differs || finals[i].T_world_cam != results[i].T_world_cam;
  }
  EXPECT_TRUE(online_differs);
}

TEST_F(Finals, AreTheObjectsOfTheProgramsFinalFiles) {
  const auto finals = finalsOf(drive_, replay()).finals;
  const auto rows = tableOf(folder_ / "objects_final.csv");
  ASSERT_FALSE(rows.empty());
  std::size_t row = 0;
  for (const Result& final : finals)
    for (const Result::Object& object : final.objects) {
      ASSERT_LT(row, rows.size());
      auto written = rows[row++];
      EXPECT_EQ(std::to_string(final.frame), written["frame"]);
      EXPECT_EQ(std::to_string(object.id), written["track_id"]);
      EXPECT_NEAR(object.T_world_body[3], std::stod(written["tx"]), 1e-5);
      EXPECT_NEAR(object.T_world_body[11], std::stod(written["tz"]), 1e-5);
      EXPECT_NEAR(object.velocity_world_mps[2], std::stod(written["vz"]), 1e-3);
      EXPECT_NEAR(object.box_size_m[0], std::stod(written["length_m"]), 1e-2);
      EXPECT_NEAR(object.existence_probability, std::stod(written["existence_probability"]), 1e-2);
    }
  EXPECT_EQ(row, rows.size());
}

TEST_F(Finals, ChangeNoResultAndAreInTheAxesThatWereChosen) {
  const auto optical = finalsOf(drive_, replay());
  EXPECT_EQ(bytesOf(optical.results), bytesOf(track(drive_)));
  Tracker::Options options = replay();
  options.axes = Tracker::Axes::kRep103;
  const auto turned = finalsOf(drive_, options).finals;
  EXPECT_EQ(turned.back().T_world_cam[3], optical.finals.back().T_world_cam[11]);   // ahead
  EXPECT_EQ(turned.back().T_world_cam[7], -optical.finals.back().T_world_cam[3]);   // to the left
  EXPECT_EQ(turned.back().T_world_cam[11], -optical.finals.back().T_world_cam[7]);  // up
}

class FinalTaking : public testing::Test {
 protected:
  static constexpr std::size_t kPairs = 40;
  void pushAll(Tracker& tracker) const {
    for (std::size_t i = 0; i < kPairs; ++i)
      ASSERT_NE(tracker.push(drive_.pair(i)).status, Tracker::Push::Status::kRejected);
    tracker.close();
  }
  const DriveInMemory drive_ = blankDrive(kPairs);
};

TEST_F(FinalTaking, GoesOnWhateverTheCallbackThrows) {
  std::mutex mutex;
  std::string log;
  Tracker::Options options = replay();
  options.log = [&](Tracker::LogLevel, const std::string& line) {
    const std::scoped_lock lock(mutex);
    log += line + "\n";
  };
  std::size_t finals = 0;
  Tracker tracker(drive_.camera, options);
  tracker.on_final([&](const Result& final) {
    ++finals;
    if (final.frame == 1) throw std::runtime_error("the disk is full");
    if (final.frame == 2) throw 3;
  });
  pushAll(tracker);
  EXPECT_EQ(rest(tracker).size(), kPairs);
  EXPECT_EQ(finals, kPairs);
  EXPECT_THAT(log, HasSubstr("callback for finals: the disk is full\n"));
  EXPECT_THAT(log, HasSubstr("callback for finals: it threw what is no std::exception\n"));
}

TEST_F(FinalTaking, EndsWithTheCallbackWhichHasReturnedByThen) {
  const auto inside = std::make_shared<std::atomic<int>>(0);
  std::atomic<std::size_t> calls = 0;
  Tracker tracker(drive_.camera, replay());
  tracker.on_final([&calls, inside](const Result&) {
    ++*inside;
    ++calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    --*inside;
  });
  std::jthread producer([&] { pushAll(tracker); });
  while (calls < 3) std::this_thread::yield();
  tracker.on_final({});
  EXPECT_EQ(*inside, 0);
  EXPECT_EQ(inside.use_count(), 1);
  const std::size_t calls_then = calls;
  EXPECT_EQ(rest(tracker).size(), kPairs);
  EXPECT_EQ(calls, calls_then);
}

TEST_F(FinalTaking, MayCallTheTrackerAndReplaceItself) {
  std::vector<std::int64_t> first, later;
  Tracker tracker(drive_.camera, replay());
  tracker.on_final([&](const Result& final) {
    EXPECT_FALSE(tracker.done());
    EXPECT_GT(tracker.counts().results, 0);
    first.push_back(final.frame);
    if (final.frame == 1) tracker.on_final([&](const Result& next) { later.push_back(next.frame); });
  });
  pushAll(tracker);
  rest(tracker);
  EXPECT_THAT(first, testing::ElementsAre(0, 1));
  EXPECT_EQ(later.size(), kPairs - 2);
}

/// The window of a tracker that goes without `close` is given up.
TEST_F(FinalTaking, IsOverWhenTheTrackerGoes) {
  for (int round = 0; round < 10; ++round) {
    const auto inside = std::make_shared<std::atomic<int>>(0);
    {
      Tracker tracker(drive_.camera, replay());
      tracker.on_final([inside](const Result&) {
        ++*inside;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        --*inside;
      });
      for (std::size_t i = 0; i < kPairs / 2; ++i) tracker.push(drive_.pair(i));
    }
    EXPECT_EQ(*inside, 0);
    EXPECT_EQ(inside.use_count(), 1);
  }
}

/// Dropped pairs have their finals, too. The live policy drops pairs here while a callback for results takes its time.
TEST_F(FinalTaking, GivesDroppedFramesTheirPredictedPoses) {
  std::vector<std::int64_t> frames, all;
  std::atomic<bool> pushed = false;
  Tracker tracker(drive_.camera, {});
  tracker.on_final([&](const Result& final) { frames.push_back(final.frame); });
  tracker.on_result([&](const Result&) { pushed.wait(false); });
  pushAll(tracker);
  pushed = true;
  pushed.notify_all();
  while (!tracker.done()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_GT(tracker.counts().dropped, 0);
  for (std::size_t i = 0; i < kPairs; ++i) all.push_back(static_cast<std::int64_t>(i));
  EXPECT_EQ(frames, all);
}

}  // namespace
}  // namespace motorcade
