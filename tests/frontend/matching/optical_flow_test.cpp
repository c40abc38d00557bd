#include "frontend/matching/optical_flow.hpp"

#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "frontend/features/feature_preparation.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kFlowWidth_px = 480, kFlowHeight_px = 240;

/// A texture that moves by (du, dv) per frame and is taken with changing exposure.
class MovingWall {
 public:
  MovingWall(double du_px, double dv_px) : du_px_(du_px), dv_px_(dv_px) {}
  FeaturesPtr at(int frame) const {
    const auto gray = [&](double x, double y) { return texture_(x - frame * du_px_, y - frame * dv_px_); };
    const test::Exposure exposure{
        .gain = 1 - 0.02 * frame, .bias = 2.0 * frame, .noise = 2, .seed = static_cast<unsigned>(frame)};
    const Image image = test::render(kFlowWidth_px, kFlowHeight_px, gray, exposure);
    return prepare_(test::stereoFrame(frame, image, image));
  }
  Eigen::Vector2d velocity_px() const { return {du_px_, dv_px_}; }

 private:
  test::Texture texture_{61, 7, 60};
  double du_px_, dv_px_;
  FeaturePreparation prepare_{{}};
};

struct Start {
  Eigen::Vector2d uv_px;
  int frame;
};

TEST(OpticalFlowTracker, DoesNotWalkAwayOverManyFrames) {
  const MovingWall wall(3.31, -1.27);
  OpticalFlowTracker track({});
  std::map<PointId, Start> starts;
  std::map<int, std::pair<double, int>> squares_at_age;
  for (int frame = 0; frame <= 12; ++frame) {
    const auto flow = track(wall.at(frame));
    for (const FlowObservation& point : flow->observations) {
      const Eigen::Vector2d uv_px(point.u_px, point.v_px);
      if (point.age == 1) starts.emplace(point.point, Start{uv_px, frame});
      const Start& start = starts.at(point.point);
      EXPECT_EQ(point.age, frame - start.frame + 1);
      const Eigen::Vector2d error_px = uv_px - start.uv_px - (frame - start.frame) * wall.velocity_px();
      auto& [squares, count] = squares_at_age[point.age];
      squares += error_px.squaredNorm() / 2;
      ++count;
    }
  }
  for (const int age : {2, 5, 8, 12}) {
    const auto [squares, count] = squares_at_age.at(age);
    EXPECT_GE(count, 100);
    const double limit_px = age <= 6 ? 0.1 : 0.14;  // a second keyframe adds its own error
    EXPECT_LT(std::sqrt(squares / count), limit_px) << age;
  }
}

TEST(OpticalFlowTracker, FollowsLargeMotionFromTheFirstFrame) {
  const MovingWall wall(-62.4, 11.7);
  OpticalFlowTracker track({});
  track(wall.at(0));
  const auto first = track(wall.at(1));
  const auto followed =
      std::ranges::count_if(first->observations, [](const FlowObservation& point) { return point.age == 2; });
  EXPECT_GE(followed, 100);
}

/// A bump in the road, or the begin of a turn.
TEST(OpticalFlowTracker, FollowsAJumpOfTheImage) {
  const test::Texture texture(61, 7, 60);
  const FeaturePreparation prepare{{}};
  for (const double jump_px : {12.0, 45.0}) {
    OpticalFlowTracker track({});
    const auto at = [&](int frame) {
      const double v_px = frame >= 5 ? jump_px : 0;
      const Image image = test::render(kFlowWidth_px, kFlowHeight_px,
                                       [&](double x, double y) { return texture(x - 2 * frame, y - v_px); },
                                       {.noise = 2, .seed = static_cast<unsigned>(frame)});
      return track(prepare(test::stereoFrame(frame, image, image)));
    };
    std::map<PointId, Eigen::Vector2d> before;
    for (int frame = 0; frame < 5; ++frame)
      for (const FlowObservation& point : at(frame)->observations) before[point.point] = {point.u_px, point.v_px};
    int followed = 0;
    for (const FlowObservation& point : at(5)->observations)
      if (point.age > 2)
        followed += (Eigen::Vector2d(point.u_px - 2, point.v_px - jump_px) - before[point.point]).norm() < 0.5;
    EXPECT_GE(followed, 100) << jump_px;
  }
}

/// A block of another texture that moves to the right across a wall at rest.
TEST(OpticalFlowTracker, FollowsWhatCrossesAStandingScene) {
  constexpr double kSpeed_px = 45;
  const test::Texture wall(61, 7, 60), vehicle(62, 7, 60);
  const FeaturePreparation prepare{{}};
  OpticalFlowTracker track({});
  const auto left_px = [&](int frame) { return 100 + frame * kSpeed_px; };
  const auto at = [&](int frame) {
    const auto gray = [&](double x, double y) {
      const bool on_vehicle = x > left_px(frame) && x < left_px(frame) + 140 && y > 80 && y < 160;
      return on_vehicle ? vehicle(x - left_px(frame), y) : wall(x, y);
    };
    const Image image =
        test::render(kFlowWidth_px, kFlowHeight_px, gray, {.noise = 2, .seed = static_cast<unsigned>(frame)});
    return track(prepare(test::stereoFrame(frame, image, image)));
  };
  const auto before = at(0), now = at(1);
  int crossing = 0;
  for (const FlowObservation& point : now->observations) {
    if (point.age < 2 || point.u_px < left_px(1) + 8 || point.u_px > left_px(1) + 132 || point.v_px < 88 ||
        point.v_px > 152)
      continue;
    const auto then = std::ranges::find(before->observations, point.point, &FlowObservation::point);
    ASSERT_NE(then, before->observations.end());
    crossing += std::abs(point.u_px - then->u_px - kSpeed_px) < 1;
  }
  EXPECT_GE(crossing, 10);
}

TEST(OpticalFlowTracker, OrdersPointsByIdsThatAreNeverUsedTwice) {
  const MovingWall wall(9.3, 2.2);
  OpticalFlowTracker track({});
  std::set<PointId> ended, alive;
  for (int frame = 0; frame < 6; ++frame) {
    const auto features = wall.at(frame);
    const auto flow = track(features);
    std::set<PointId> now;
    for (std::size_t i = 0; i < flow->observations.size(); ++i) {
      const FlowObservation& point = flow->observations[i];
      EXPECT_TRUE(i == 0 || flow->observations[i - 1].point < point.point);
      EXPECT_FALSE(ended.contains(point.point));
      EXPECT_EQ(point.age == 1, point.corner >= 0);
      EXPECT_EQ(point.age == 1, !alive.contains(point.point));
      EXPECT_TRUE(point.corner < 0 || point.u_px == features->corners[point.corner].u_px);
      now.insert(point.point);
    }
    for (const PointId point : alive)
      if (!now.contains(point)) ended.insert(point);
    alive = now;
  }
  EXPECT_FALSE(ended.empty());
}

TEST(OpticalFlowTracker, KeepsPointsApartAndSpread) {
  const MovingWall wall(5.5, 0.4);
  OpticalFlowTracker::Params params;
  params.max_tracks = 150;
  OpticalFlowTracker track(params);
  for (int frame = 0; frame < 4; ++frame) {
    const auto flow = track(wall.at(frame));
    EXPECT_LE(flow->observations.size(), 150U);
    std::set<std::pair<int, int>> cells;
    for (std::size_t i = 0; i < flow->observations.size(); ++i) {
      const FlowObservation& a = flow->observations[i];
      cells.emplace(static_cast<int>(a.u_px) / OpticalFlowTracker::kCell_px,
                    static_cast<int>(a.v_px) / OpticalFlowTracker::kCell_px);
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GE(std::hypot(a.u_px - flow->observations[j].u_px, a.v_px - flow->observations[j].v_px),
                  0.99 * OpticalFlowTracker::kMinDistance_px);
    }
    EXPECT_GE(cells.size(), 45U);  // of 50
  }
}

FeaturesPtr at(const FeaturesPtr& features, int frame) {
  auto stamped = std::make_shared<StereoFrame>(*features->frame);
  stamped->head.frame = {frame};
  stamped->head.stamp = {frame * 100'000'000};
  auto copy = std::make_shared<Features>(*features);
  copy->frame = stamped;
  return copy;
}

FeaturesPtr uniform(std::uint8_t gray, const Features& like) {
  const Image& size = like.left.levels.front();
  const Image image = test::render(size.width(), size.height(), [gray](double, double) { return gray; });
  return FeaturePreparation({})(test::stereoFrame(0, image, image));
}

/// Number of points that have been followed for `age` frames and more.
std::ptrdiff_t countOfAge(const OpticalFlow& flow, int age) {
  return std::ranges::count_if(flow.observations, [age](const FlowObservation& point) { return point.age >= age; });
}

TEST(OpticalFlowTracker, PointsWaitWhileImagesAreOfNoUse) {
  const MovingWall wall(3, 0);
  const FeaturesPtr rejected = FeaturePreparation({})(test::rejectedFrame(3)), black = uniform(0, *wall.at(0)),
                    frozen = wall.at(2);
  for (const FeaturesPtr& useless : {rejected, black, frozen}) {
    OpticalFlowTracker track({});
    for (int frame = 0; frame < 3; ++frame) track(at(wall.at(frame), frame));
    EXPECT_TRUE(track(at(useless, 3))->observations.empty());
    EXPECT_TRUE(track(at(useless, 4))->observations.empty());
    const auto after = track(at(wall.at(5), 5));
    EXPECT_GT(countOfAge(*after, 4), 0.7 * static_cast<double>(after->observations.size()));
  }
}

TEST(OpticalFlowTracker, PointsStartAnewAfterALongTimeWithoutImages) {
  const MovingWall wall(3, 0);
  OpticalFlowTracker track({});
  const auto before = track(at(wall.at(0), 0));
  for (int frame = 1; frame < 7; ++frame) track(at(FeaturePreparation({})(test::rejectedFrame(frame)), frame));
  const auto after = track(at(wall.at(7), 7));
  ASSERT_FALSE(after->observations.empty());
  EXPECT_GT(after->observations.front().point, before->observations.back().point);
  EXPECT_EQ(countOfAge(*after, 2), 0);
}

/// A sharp image of which hardly anything is known: at 10 Hz something is wrong with it, at 3.3 Hz the camera went on.
TEST(OpticalFlowTracker, PointsStartAnewWhereSparseFramesShowFewOfThem) {
  const MovingWall wall(3, 0), elsewhere(0, 500);
  for (const int interval : {1, 3}) {
    OpticalFlowTracker track({});
    for (int frame = 0; frame < 3; ++frame) track(at(wall.at(frame), interval * frame));
    const auto flow = track(at(elsewhere.at(1), interval * 3));
    EXPECT_EQ(flow->observations.empty(), interval == 1);
    EXPECT_EQ(countOfAge(*flow, 2), 0);
  }
}

TEST(OpticalFlowTracker, PointsWaitForABetterImageAlsoWhereFramesAreSparse) {
  const MovingWall wall(3, 0);
  const FeaturesPtr black = uniform(0, *wall.at(0)), frozen = wall.at(2);
  for (const FeaturesPtr& useless : {black, frozen}) {
    OpticalFlowTracker track({});
    for (int frame = 0; frame < 3; ++frame) track(at(wall.at(frame), 2 * frame));
    EXPECT_TRUE(track(at(useless, 6))->observations.empty());
    const auto after = track(at(wall.at(4), 8));
    EXPECT_GT(countOfAge(*after, 4), 0.7 * static_cast<double>(after->observations.size()));
  }
}

TEST(OpticalFlowTracker, StartsAgainWhenTheImageSizeChanges) {
  const Image small = test::render(200, 120, test::Texture(62));
  OpticalFlowTracker track({});
  track(MovingWall(1, 0).at(0));
  const auto flow = track(FeaturePreparation({})(test::stereoFrame(1, small, small)));
  EXPECT_TRUE(std::ranges::all_of(flow->observations, [](const FlowObservation& point) { return point.age == 1; }));
}

}  // namespace
}  // namespace motorcade
