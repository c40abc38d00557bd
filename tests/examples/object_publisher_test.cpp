#include "object_publisher.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace vehicle_stack {
namespace {

using namespace std::chrono_literals;
using motorcade::Result;
using nlohmann::json;
using testing::ElementsAre;
using testing::SizeIs;

Result::Object someObject(std::int64_t id) {
  Result::Object object;
  object.id = id;
  object.T_cam_body = {0, -1, 0, 12, 1, 0, 0, 3, 0, 0, 1, -1};  // turned by 90 degrees to the left
  object.covariance.emplace().fill(-0.123456789e-8);
  object.velocity_covariance.fill(-0.123456789e-8);
  object.box_size_m = {4, 2, 1.5};
  object.kind = Result::Kind::kCar;
  object.existence_probability = 0.875;
  object.acceleration = {.along_mps2 = -2.5, .along_sigma_mps2 = 0.5, .yaw_radps2 = 0.25, .yaw_sigma_radps2 = 0.125};
  return object;
}

Result someResult(std::vector<Result::Object> objects) {
  Result result;
  result.frame = 7;
  result.stamp_ns = 1'300'000'000'123'456'789;
  result.T_world_cam = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  result.objects = std::move(objects);
  return result;
}

class ObjectPublisherTest : public testing::Test {
 protected:
  const json& last() const { return lines_.back(); }

  std::vector<json> lines_;
  std::size_t longest_ = 0;
  ObjectPublisher publisher_{VehicleFrame({.z_m = 1.5}, 1), 500ms, [this](const std::string& line) {
                               EXPECT_EQ(line.find('\n'), line.size() - 1);
                               longest_ = std::max(longest_, line.size());
                               lines_.push_back(json::parse(line));
                             }};
};

TEST_F(ObjectPublisherTest, ALineTellsOfTheFrameAndOneOfEachObject) {
  publisher_.publish(someResult({someObject(4), someObject(9)}), Level::kHealthy);
  ASSERT_THAT(lines_, SizeIs(3));
  EXPECT_EQ(lines_[0]["type"], "frame");
  EXPECT_EQ(lines_[0]["objects"], 2);
  EXPECT_EQ(lines_[0]["stamp_ns"], 1'300'000'000'123'456'789);
  EXPECT_EQ(lines_[0]["ego_velocity"].size(), 6u);
  EXPECT_EQ(lines_[1]["id"], 4);
  EXPECT_EQ(last()["kind"], "car");
  EXPECT_EQ(last()["existence_probability"], 0.875);
  EXPECT_EQ(last()["acceleration_mps2"], -2.5);
  EXPECT_EQ(last()["acceleration_sigma_mps2"], 0.5);
  EXPECT_EQ(last()["yaw_acceleration_radps2"], 0.25);
  EXPECT_EQ(last()["yaw_acceleration_sigma_radps2"], 0.125);
  EXPECT_EQ(last()["position_m"], json({12, 3, 0.5}));
  EXPECT_THAT(last()["pose_covariance"], SizeIs(36));
  EXPECT_NEAR(last()["orientation_xyzw"][2], std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(last()["orientation_xyzw"][3], std::sqrt(0.5), 1e-6);
}

TEST_F(ObjectPublisherTest, NoLineIsLongerThanAPipeTakesAtOnce) {
  Result result = someResult({someObject(1)});
  result.velocity.fill(-0.123456789e-8);
  result.velocity_covariance.fill(0.123456789e-8);
  result.problem = "a sentence of its own, as long as the tracker's are when a stage of the pipeline could not work";
  publisher_.publish(result, Level::kHealthy);
  EXPECT_LT(longest_, 4096U);
}

TEST_F(ObjectPublisherTest, WhatAProblemSaysIsQuoted) {
  Result result = someResult({});
  result.problem = "\"left\\1.png\"\nis dark";
  publisher_.publish(result, Level::kHealthy);
  EXPECT_EQ(last()["problem"], result.problem);
}

TEST_F(ObjectPublisherTest, WhatIsNoNumberIsNull) {
  Result::Object object = someObject(1);
  object.age_s = NAN;
  object.covariance.reset();
  object.box_size_m = {};
  publisher_.publish(someResult({object}), Level::kHealthy);
  EXPECT_TRUE(last()["age_s"].is_null());
  EXPECT_TRUE(last()["pose_covariance"].is_null());
  EXPECT_TRUE(last()["box_center_m"].is_null());
  EXPECT_EQ(last()["trust"], "uncertain");
}

TEST_F(ObjectPublisherTest, ObjectsThatWereValidAreStaleOnceWhenItBecomesBlind) {
  HealthMonitor health({}, {});
  publisher_.publish(someResult({someObject(4), someObject(9)}), Level::kHealthy);
  publisher_.publish(health, {}, "");
  EXPECT_THAT(last()["stale_objects"], ElementsAre());
  ASSERT_TRUE(health.check(HealthMonitor::Time{} + 10s));  // nothing was measured since the start
  publisher_.publish(health, {}, "the camera has given no pair");
  EXPECT_EQ(last()["level"], "blind");
  EXPECT_EQ(last()["objects_valid"], false);
  EXPECT_THAT(last()["stale_objects"], ElementsAre(4, 9));
  publisher_.publish(health, {}, "");
  EXPECT_THAT(last()["stale_objects"], ElementsAre());
}

TEST(Quaternion, IsThatOfTheRotationOnEachOfItsBranches) {
  for (const auto& q : {std::array{0.1, 0.2, 0.3, 0.9}, std::array{0.9, -0.2, 0.3, 0.1},
                        std::array{-0.1, 0.9, 0.3, -0.2}, std::array{0.1, -0.3, 0.9, 0.2}}) {
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
    const Matrix3 R{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),  //
                     2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),  //
                     2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    const auto found = quaternionOf(R);
    const double agreement = found[0] * x + found[1] * y + found[2] * z + found[3] * w;
    EXPECT_NEAR(std::abs(agreement), 1, 1e-12);  // q and -q are the same rotation
  }
}

TEST(Trust, IsNeverMoreThanLevelFrameAndObjectAllow) {
  const Result good, lost{.status = Result::Status::kLost}, doubtful{.cause = Result::Cause::kAfterGap},
      wrong_rig{.problem = "the pairs are not rectified"};
  EXPECT_EQ(trustIn(good, Level::kHealthy), Trust::kMeasured);
  EXPECT_EQ(trustIn(good, Level::kDegraded), Trust::kUncertain);
  EXPECT_EQ(trustIn(doubtful, Level::kHealthy), Trust::kUncertain);
  EXPECT_EQ(trustIn(lost, Level::kHealthy), Trust::kPredicted);
  EXPECT_EQ(trustIn(wrong_rig, Level::kHealthy), Trust::kNone);
  EXPECT_EQ(trustIn(good, Level::kBlind), Trust::kNone);
  EXPECT_EQ(trustIn(good, Level::kStarting), Trust::kNone);

  Result::Object object = someObject(1);
  EXPECT_EQ(trustIn(object, Trust::kMeasured), Trust::kMeasured);
  object.covariance.reset();
  EXPECT_EQ(trustIn(object, Trust::kMeasured), Trust::kUncertain);
  EXPECT_EQ(trustIn(object, Trust::kPredicted), Trust::kPredicted);
  object.state = Result::State::kPredicted;
  EXPECT_EQ(trustIn(object, Trust::kMeasured), Trust::kPredicted);
  EXPECT_EQ(trustIn(object, Trust::kNone), Trust::kNone);
}

}  // namespace
}  // namespace vehicle_stack
