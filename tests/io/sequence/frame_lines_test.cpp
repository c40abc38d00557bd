#include "io/sequence/frame_lines.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 100'000'000;

/// Frames of numbers 0 to 9; some lack an image.
Sequence sequenceOf(const std::vector<int>& left_missing, const std::vector<int>& right_missing) {
  Sequence sequence;
  sequence.frames.resize(10);
  for (const int frame : left_missing) sequence.frames[frame].left_missing = true;
  for (const int frame : right_missing) sequence.frames[frame].right_missing = true;
  return sequence;
}

std::vector<Timestamp> timesOf(const std::vector<int>& numbers) {
  std::vector<Timestamp> times;
  for (const int number : numbers) times.push_back({number * kPeriod_ns});
  return times;
}

std::vector<std::int64_t> placesAfter(Sequence sequence, const std::vector<Timestamp>& times) {
  setStampsOfLines(sequence, times, "times.txt");
  std::vector<std::int64_t> places;
  for (const Timestamp stamp : sequence.stamps) places.push_back(stamp.ns / (kPeriod_ns / 10));
  return places;
}

TEST(FrameLines, TimesAreThoseOfNumbersOfLeftImagesOrOfPairs) {
  const Sequence sequence = sequenceOf({3}, {6, 7});
  const auto all = ElementsAre(0, 10, 20, 30, 40, 50, 60, 70, 80, 90);
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 3, 4, 5, 6, 7, 8, 9})), all);
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 4, 5, 6, 7, 8, 9})), all);  // left images
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 3, 4, 5, 8, 9})), all);     // right images
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 4, 5, 8, 9})), all);        // pairs
}

TEST(FrameLines, WhereBothSidesLackAsManyTheTimesTellWhoseTheyAre) {
  const Sequence sequence = sequenceOf({3}, {6});
  const auto all = ElementsAre(0, 10, 20, 30, 40, 50, 60, 70, 80, 90);
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 4, 5, 6, 7, 8, 9})), all);
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 3, 4, 5, 7, 8, 9})), all);
}

TEST(FrameLines, TimesThatPassOverNothingAreRefused) {
  const auto failed = [](const std::vector<int>& numbers) {
    return messageOf<InputError>([&] { placesAfter(sequenceOf({3}, {6}), timesOf(numbers)); });
  };
  EXPECT_THAT(failed({0, 1, 2, 3, 4, 5, 6, 7, 8}),
              AllOf(HasSubstr("times.txt: has 9 times, which pass over no image"), HasSubstr("each number (10)"),
                    HasSubstr("each left image (9)"), HasSubstr("each pair (8)")));
  EXPECT_THAT(failed({0, 1, 2}), AllOf(HasSubstr("has 3 times, but images are missing"), HasSubstr("number (10)")));
}

TEST(FrameLines, NumbersWithoutImagesAreNoFramesWhereTimeDoesNotPass) {
  const Sequence sequence = sequenceOf({4, 5}, {4, 5});
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 3, 6, 7, 8, 9})),
              ElementsAre(0, 10, 20, 30, 40, 50, 60, 70, 80, 90));
  EXPECT_THAT(placesAfter(sequence, timesOf({0, 1, 2, 3, 4, 5, 6, 7})), ElementsAre(0, 10, 20, 30, 40, 50, 60, 70));
}

TEST(FrameLines, TimesOfLaterNumbersMayBeginAtZero) {
  Sequence cut_out = sequenceOf({}, {});
  cut_out.numbering.first = 4;
  EXPECT_THAT(placesAfter(cut_out, timesOf({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13})),
              ElementsAre(40, 50, 60, 70, 80, 90, 100, 110, 120, 130));
  Sequence every_second = sequenceOf({}, {});
  every_second.numbering.step = 2;
  std::vector<int> numbers(20);
  for (int i = 0; i < 20; ++i) numbers[i] = i;
  EXPECT_THAT(placesAfter(every_second, timesOf(numbers)), ElementsAre(0, 20, 40, 60, 80, 100, 120, 140, 160, 180));
}

TEST(FrameLines, PosesOfFramesWithoutLineAreInterpolated) {
  const Sequence sequence = sequenceOf({3}, {6, 7});
  std::vector<SE3> poses;  // of the left images
  for (const int number : {0, 1, 2, 4, 5, 6, 7, 8, 9})
    poses.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(number, 0, 0));
  const auto all = posesOfFrames(sequence, poses, "poses.txt");
  ASSERT_EQ(all.size(), 10U);
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(all[i].translation().x(), i, 1e-12);
  poses.resize(4);
  EXPECT_THAT(messageOf<InputError>([&] { posesOfFrames(sequence, poses, "poses.txt"); }),
              AllOf(HasSubstr("poses.txt: has 4 poses"), HasSubstr("each left image (9)")));
}

TEST(FrameLines, PeriodsThatNoCameraHasAreTold) {
  const auto noteOf = [](std::int64_t period_ns) {
    Sequence sequence = sequenceOf({}, {});
    for (int i = 0; i < 10; ++i) sequence.stamps.push_back({period_ns * i});
    tellPeriod(sequence);
    return sequence.notes.empty() ? InputNote{} : sequence.notes.front();
  };
  EXPECT_EQ(noteOf(kPeriod_ns).text, "");
  EXPECT_THAT(noteOf(3'000'000'000).text, HasSubstr("3 s apart"));
  EXPECT_FALSE(noteOf(3'000'000'000).worthless);
  EXPECT_TRUE(noteOf(100'000'000'000).worthless);
  EXPECT_TRUE(noteOf(100'000).worthless);
}

}  // namespace
}  // namespace motorcade
