#include "apps/watch/rig_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "apps/inject/image_faults.hpp"

namespace motorcade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kWidth_px = 480, kHeight_px = 240;
constexpr StereoCamera kWallCamera{300, 300, 240, 120, 0.5, kWidth_px, kHeight_px};

/// A wall full of spots, toward which the cameras drive. It leans, so that its lower parts are nearer.
class Wall {
 public:
  Wall() : gray_(kSide_px * kSide_px) {
    constexpr int kSpots = 12000, kReach_px = 4;
    std::mt19937_64 random(5);
    std::uniform_int_distribution<int> place(kReach_px, kSide_px - kReach_px - 1), level(-70, 70);
    std::ranges::fill(gray_, 110);
    for (int i = 0; i < kSpots; ++i) {
      const int x = place(random), y = place(random), gray = level(random);
      for (int v = -kReach_px; v <= kReach_px; ++v)
        for (int u = -kReach_px; u <= kReach_px; ++u)
          gray_[(y + v) * kSide_px + x + u] += static_cast<float>(gray * std::exp(-(u * u + v * v) / 6.0));
    }
  }

  /// View of a camera at a frame, its content so many pixels farther to the left in the middle row, and less above it.
  Image seen(int frame, double left_px, ImagePool& pool, double lean = 0.8) const {
    const double scale = 1.6 * std::pow(0.97, frame % kFramesOfApproach);
    Image image = pool.acquire(kWidth_px, kHeight_px);
    std::mt19937_64 random(static_cast<std::uint64_t>(frame) + 1000);
    std::normal_distribution<double> noise(0, 1.5);
    for (int y = 0; y < kHeight_px; ++y)
      for (int x = 0; x < kWidth_px; ++x) {
        const double down = (y - kWallCamera.cy_px) / kWallCamera.cy_px, moved_px = left_px * (1 + lean * down);
        const double gray =
            at(scale * (x + moved_px - kWallCamera.cx_px), scale * (y - kWallCamera.cy_px)) + noise(random);
        image.mutableRow(y)[x] = static_cast<std::uint8_t>(std::clamp(gray, 0.0, 255.0));
      }
    return image;
  }

  static constexpr int kFramesOfApproach = 20;  // then it begins anew

 private:
  static constexpr int kSide_px = 1000;
  double at(double x, double y) const {
    x += kSide_px / 2.0, y += kSide_px / 2.0;
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const double u = x - left, v = y - top;
    const float* const pixel = &gray_[static_cast<std::size_t>(top) * kSide_px + left];
    return (1 - v) * ((1 - u) * pixel[0] + u * pixel[1]) + v * ((1 - u) * pixel[kSide_px] + u * pixel[kSide_px + 1]);
  }

  std::vector<float> gray_;
};

/// A drive of pairs, each as `change` leaves it.
class Drive {
 public:
  using Change = std::function<void(StereoFrame&, ImagePool&)>;

  StereoFrame pair(int frame) {
    constexpr double kDisparity_px = 24;
    StereoFrame pair;
    pair.head.frame = {frame};
    pair.head.stamp = {frame * std::int64_t{100'000'000}};
    pair.left = wall_.seen(frame, 0, pool_);
    pair.right = wall_.seen(frame, kDisparity_px, pool_);
    return pair;
  }
  /// Shows so many frames to a watch; returns its findings, with the frame of each.
  std::vector<std::pair<int, RigFinding>> watched(RigWatch& watch, int frames, const Change& change) {
    std::vector<std::pair<int, RigFinding>> found;
    for (int frame = 0; frame < frames; ++frame) {
      StereoFrame now = pair(frame);
      right_before_ = std::exchange(right_taken_, now.right);
      change(now, pool_);
      for (RigFinding& each : watch.observe(now)) found.emplace_back(frame, std::move(each));
    }
    for (RigFinding& each : watch.finish()) found.emplace_back(frames, std::move(each));
    return found;
  }
  const Image& rightBefore() const { return right_before_; }

 private:
  Wall wall_;
  ImagePool pool_;
  Image right_before_, right_taken_;
};

bool within(const StereoFrame& pair, int begin, int end) {
  return pair.head.frame.value >= begin && pair.head.frame.value < end;
}

TEST(RigWatch, IsQuietWhereTheRigStaysAsItIs) {
  Drive drive;
  RigWatch watch(kWallCamera);
  EXPECT_THAT(drive.watched(watch, 39, [](StereoFrame&, ImagePool&) {}), IsEmpty());
  EXPECT_FALSE(watch.worthless());
}

/// Changes that begin one to five pairs after a glance.
TEST(RigWatch, TellsWithinTwentyPairsWhatBecomesOfTheRig) {
  Drive drive;
  const struct {
    std::string name;
    Drive::Change change;
  } cases[] = {{"exchanged", [](StereoFrame& pair, ImagePool&) { std::swap(pair.left, pair.right); }},
               {"apart", [&](StereoFrame& pair, ImagePool&) { pair.right = drive.rightBefore(); }},
               {"rows", [](StereoFrame& pair, ImagePool& pool) { pair.right = lowered(pair.right, 2, pool); }},
               {"roll", [](StereoFrame& pair, ImagePool& pool) { pair.right = rolled(pair.right, 0.02, pool); }}};
  int begin = 21;
  for (const auto& each : cases) {
    SCOPED_TRACE(each.name);
    RigWatch watch(kWallCamera);
    const auto found = drive.watched(watch, 39, [&](StereoFrame& pair, ImagePool& pool) {
      if (within(pair, begin, 39)) each.change(pair, pool);
    });
    ASSERT_THAT(found, SizeIs(1));
    const auto& [at, finding] = found.front();
    EXPECT_EQ(finding.finding.name, each.name);
    EXPECT_TRUE(finding.finding.worthless && watch.worthless());
    EXPECT_LT(at, begin + 20);
    ASSERT_TRUE(finding.last_good.has_value());
    EXPECT_LT(finding.last_good->value, begin);
    EXPECT_GE(finding.first_bad.value, begin);
    EXPECT_THAT(finding.text(), HasSubstr("between frames " + std::to_string(finding.last_good->value) + " and "));
    ++begin;
  }
}

TEST(RigWatch, NamesACameraThatHangs) {
  constexpr int kBegin = 26;
  for (const std::string side : {"left", "right"}) {
    SCOPED_TRACE(side);
    Drive drive;
    RigWatch watch(kWallCamera);
    Image last;
    const auto found = drive.watched(watch, 50, [&](StereoFrame& pair, ImagePool&) {
      Image& image = side == "left" ? pair.left : pair.right;
      if (within(pair, kBegin, 50))
        image = last;
      else
        last = image;
    });
    ASSERT_FALSE(found.empty());
    const RigFinding& finding = found.back().second;
    EXPECT_EQ(finding.finding.name, "frozen");
    EXPECT_THAT(finding.text(), HasSubstr("the " + side + " camera hangs"));
    EXPECT_EQ(finding.last_good->value, kBegin - 1);
    EXPECT_EQ(found.back().first, kBegin + FrozenCamera::kPairs - 1);
    EXPECT_TRUE(finding.finding.worthless && watch.worthless());
  }
}

TEST(RigWatch, ACameraMayHangForSomePairsOrBeDarkAndADriveMayRepeat) {
  Drive drive;
  RigWatch watch(kWallCamera);
  const StereoFrame first = drive.pair(0);
  Image last;
  EXPECT_THAT(drive.watched(watch, 80,
                            [&](StereoFrame& pair, ImagePool& pool) {
                              if (within(pair, 22, 25)) pair.right = last;
                              if (within(pair, 30, 55)) pair.left = first.left, pair.right = first.right;
                              if (within(pair, 60, 80)) pair.right = filled(pair.right, 0, pool);
                              last = pair.right;
                            }),
              IsEmpty());
}

TEST(RigWatch, PassesOverAFewBadPairs) {
  Drive drive;
  RigWatch watch(kWallCamera);
  EXPECT_THAT(drive.watched(watch, 39,
                            [](StereoFrame& pair, ImagePool&) {
                              if (within(pair, 23, 28)) std::swap(pair.left, pair.right);
                            }),
              IsEmpty());
}

TEST(RigWatch, TellsOfAChangeAgainAfterTheRigWasGood) {
  Drive drive;
  RigWatch watch(kWallCamera);
  const auto found = drive.watched(watch, 110, [](StereoFrame& pair, ImagePool&) {
    if (within(pair, 25, 40) || within(pair, 70, 110)) std::swap(pair.left, pair.right);
  });
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_LT(found[0].first, 45);
  EXPECT_GE(found[1].second.first_bad.value, 70);
  EXPECT_LT(found[1].first, 90);
}

TEST(RigWatch, JudgesByTheFirstPairsInWhichSomethingIsSeen) {
  Drive drive;
  RigWatch watch(kWallCamera);
  const auto found = drive.watched(watch, 36, [](StereoFrame& pair, ImagePool& pool) {
    if (within(pair, 0, 15)) pair.left = pair.right = filled(pair.left, 0, pool);
    pair.right = lowered(pair.right, 3, pool);
  });
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].second.finding.name, "rows");
  EXPECT_EQ(found[0].first, 15 + static_cast<int>(InputCheck::kPairs) - 1);
  EXPECT_FALSE(found[0].second.last_good.has_value());
}

/// A run finds what `check` finds in the first pairs.
TEST(RigWatch, FindsInTheFirstPairsWhatTheCheckFinds) {
  Drive drive;
  for (const double rows_px : {0.5, 0.9, 1.1, 1.3, 2.0}) {
    RigWatch watch(kWallCamera);
    InputCheck check(kWallCamera);
    const auto found = drive.watched(watch, 20, [&](StereoFrame& pair, ImagePool& pool) {
      pair.right = lowered(pair.right, rows_px, pool);
      check.observe(pair);
    });
    const auto findings = check.findings();
    ASSERT_EQ(found.size(), findings.size()) << rows_px;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].second.finding.text, findings[i].text);
      EXPECT_EQ(found[i].second.finding.worthless, findings[i].worthless);
    }
  }
}

TEST(InputCheck, JudgesTheRowsOfImagesWithUnequalContrast) {
  Drive drive;
  InputCheck check(kWallCamera);
  ImagePool pool;
  for (int frame = 0; frame < 20; ++frame) {
    StereoFrame pair = drive.pair(frame);
    pair.right = exposed(lowered(pair.right, 2, pool), 0.2, pool);
    check.observe(pair);
  }
  std::vector<std::string> names;
  for (const Finding& finding : check.rigFindings()) names.push_back(finding.name);
  EXPECT_THAT(names, ElementsAre("rows"));
}

TEST(InputCheck, NamesImagesThatLieHalfAFrameApart) {
  Drive drive;
  InputCheck check(kWallCamera);
  for (int frame = 0; frame < 19; ++frame) {
    StereoFrame pair = drive.pair(2 * frame);
    pair.right = drive.pair(2 * frame + 1).right;
    pair.head.frame = {frame};
    check.observe(pair);
  }
  const auto findings = check.rigFindings();
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_TRUE(findings[0].worthless) << findings[0].text;
}

/// A shift of the rows and a lift of the camera look alike there.
TEST(InputCheck, NamesRowsThatDifferBeforeAWallToo) {
  const Wall wall;
  ImagePool pool;
  InputCheck check(kWallCamera);
  for (int frame = 0; frame < 20; ++frame) {
    StereoFrame pair;
    pair.head.frame = {frame};
    pair.left = wall.seen(frame, 0, pool, 0);
    pair.right = lowered(wall.seen(frame, 24, pool, 0), 2.5, pool);
    check.observe(pair);
  }
  const auto findings = check.rigFindings();
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings.back().name, "rows");
  EXPECT_TRUE(findings.back().worthless);
}

TEST(InputCheck, IgnoresPairsThatComeAfterTheirTurn) {
  Drive drive;
  InputCheck check(kWallCamera);
  check.observe(drive.pair(5));
  check.observe(drive.pair(3));
  check.observe(drive.pair(5));
  EXPECT_EQ(check.pairs(), 1U);
}

}  // namespace
}  // namespace motorcade
