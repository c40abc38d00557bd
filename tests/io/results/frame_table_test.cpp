#include "io/results/frame_table.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/results/timing_by_hand.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::timingOf;

TEST(FrameTable, ARowComesBackAsWritten) {
  const test::TemporaryFolder folder;
  FrameTiming late = timingOf(7);
  late.head.cause = FrameCause::kFewPoints;
  const auto file = folder.write("frames.csv", framesHeader() + "\n" + frameLine(late) + "\n");
  const auto rows = readFrames(file);
  ASSERT_EQ(rows.size(), 1u);
  const FrameRow& row = rows.front();
  EXPECT_TRUE(row.has_waits);
  EXPECT_EQ(row.head.frame.value, 7);
  EXPECT_EQ(row.head.cause, FrameCause::kFewPoints);
  EXPECT_DOUBLE_EQ(row.latency_ms, late.latency_ms());
  EXPECT_DOUBLE_EQ(row.decode_ms, 8);
  EXPECT_DOUBLE_EQ(row.entry_wait_ms, 2);
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    EXPECT_DOUBLE_EQ(row.stages[stage].work_ms, 3);
    EXPECT_NEAR(row.stages[stage].wait_ms, late.wait_ms(static_cast<Stage>(stage)), 1e-9);
    EXPECT_DOUBLE_EQ(row.stages[stage].cpu_ms, 2.5);
  }
  EXPECT_DOUBLE_EQ(row.publish_wait_ms, 1);
  EXPECT_EQ(row.points, 300);
  EXPECT_EQ(row.inliers, 250);
  EXPECT_EQ(row.objects, 2);
}

TEST(FrameTable, HasAColumnForEachField) {
  const auto columns = [](const std::string& line) { return std::ranges::count(line, ','); };
  EXPECT_EQ(columns(framesHeader()), columns(frameLine(timingOf(0))));
}

TEST(FrameTable, FilesOfEarlierVersionsHaveNoWaits) {
  const test::TemporaryFolder folder;
  const std::string header = framesHeader();
  const auto second = folder.write("second.csv", header.substr(0, header.find(",entry_wait_ms")) +
                                                     "\n3,degraded,300,30.5,8,1,2,3,4,5,6,7,after_gap,1\n");
  const auto rows = readFrames(second);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_FALSE(rows[0].has_waits);
  EXPECT_EQ(rows[0].head.cause, FrameCause::kAfterGap);
  EXPECT_EQ(rows[0].head.segment, 1);
  const auto first =
      folder.write("first.csv", header.substr(0, header.find(",cause")) + "\n4,good,400,20,8,1,2,3,4,5,6,7\n");
  EXPECT_DOUBLE_EQ(readFrames(first).at(0).stages.back().work_ms, 7);
}

TEST(FrameTable, ColumnsAreReadByTheirNames) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("frames.csv",
                                 "frame,status,stamp_ns,latency_ms,extra,tracking_ms,objects,cause\n"
                                 "4,degraded,400,21.5,x,0.75,3,after_gap\n"
                                 "5,good,500,2");
  const auto rows = readFrames(file);
  ASSERT_EQ(rows.size(), 1u) << "the second line was cut off";
  EXPECT_EQ(rows[0].latency_ms, 21.5);
  EXPECT_EQ(rows[0].stages[static_cast<std::size_t>(Stage::kTracking)].work_ms, 0.75);
  EXPECT_EQ(rows[0].stages[0].work_ms, 0);
  EXPECT_EQ(rows[0].objects, 3);
  EXPECT_EQ(rows[0].head.cause, FrameCause::kAfterGap);
}

TEST(FrameTable, NamesFileAndLineOfWhatIsMissing) {
  const test::TemporaryFolder folder;
  const std::string line = frameLine(timingOf(0));
  const auto file =
      folder.write("frames.csv", framesHeader() + "\n" + line.substr(0, line.rfind(',')) + "\n" + line + "\n");
  EXPECT_THAT(test::messageOf<InputError>([&] { readFrames(file); }),
              testing::AllOf(testing::HasSubstr("frames.csv"), testing::HasSubstr("2"), testing::HasSubstr("objects")));
}

}  // namespace
}  // namespace motorcade
