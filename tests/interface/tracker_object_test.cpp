#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/interface/result_truth.hpp"
#include "tests/interface/tracked_drive.hpp"

/// Tests the results on a car that drives ahead, of which the truth is known.
namespace motorcade {
namespace {

constexpr double kPeriod_s = 0.1;

class CarAhead : public testing::Test {
 protected:
  struct Sight {
    const Result& result;
    const Result::Object& car;
    Transform T_cam_car;  // the truth
    Eigen::Vector3d velocity_mps;
  };

  /// Calls `look` with each frame that reports the car; no other object is reported.
  template <class Look>
  void forEachSight(const Look& look) {
    int seen = 0;
    for (const Result& result : results_) {
      if (result.objects.empty()) continue;
      ASSERT_EQ(result.objects.size(), 1u);
      const auto i = static_cast<std::size_t>(result.frame);
      const Eigen::Matrix4d step = truth_.T_world_car[i] - truth_.T_world_car[i - 1];
      SCOPED_TRACE(testing::Message() << "frame " << i);
      look(Sight{result, result.objects.front(), truth_.T_world_cam[i].inverse() * truth_.T_world_car[i],
                 step.topRightCorner<3, 1>() / kPeriod_s});
      ++seen;
    }
    EXPECT_GE(seen, 8);
  }

  static Tracker::Options withMasks() {
    Tracker::Options options = replay();
    options.masks = true;
    return options;
  }
  const DriveInMemory drive_ = readDrive(MOTORCADE_SMALL_SEQUENCE);
  const Truth truth_ = readTruth(MOTORCADE_SMALL_SEQUENCE);
  const std::vector<Result> results_ = track(drive_, withMasks());
};

TEST_F(CarAhead, MovesAsItDoes) {
  forEachSight([](const Sight& sight) {
    const Result::Object& car = sight.car;
    EXPECT_EQ(car.state, Result::State::kMoving);
    const double error_mps = (vectorOf(car.velocity_world_mps) - sight.velocity_mps).norm();
    EXPECT_LT(error_mps, 1.5);  // of 12 m/s, by some points a few pixels apart
    EXPECT_LT(error_mps, 5 * std::sqrt(squareOf(car.velocity_covariance).trace()));
    EXPECT_LT(std::abs(car.yaw_rate_radps), 0.1);  // it drives straight on
    EXPECT_GT(car.yaw_rate_sigma_radps, 0);
    EXPECT_LT(car.yaw_rate_sigma_radps, 0.2);
    ASSERT_TRUE(car.acceleration);  // it keeps its speed and its course
    EXPECT_LT(std::abs(car.acceleration->along_mps2), 3 * car.acceleration->along_sigma_mps2);
    EXPECT_LT(car.acceleration->along_sigma_mps2, 5);
    EXPECT_LT(std::abs(car.acceleration->yaw_radps2), 3 * car.acceleration->yaw_sigma_radps2);
    EXPECT_LT(car.acceleration->yaw_sigma_radps2, 1);
    EXPECT_GE(car.points, 3);
  });
}

TEST_F(CarAhead, IsWhereItIs) {
  forEachSight([](const Sight& sight) {
    const Transform T_cam_body = transformOf(sight.car.T_cam_body);
    EXPECT_TRUE(
        (transformOf(sight.result.T_world_cam) * T_cam_body).isApprox(transformOf(sight.car.T_world_body), 1e-9));
    EXPECT_TRUE(sight.car.covariance);
    constexpr double kMost_rad = 0.1;
    const Eigen::Vector3d ahead = (sight.T_cam_car.inverse() * T_cam_body).topLeftCorner<3, 1>();
    EXPECT_LT(std::acos(std::min(1.0, ahead.x())), kMost_rad);
    const Eigen::Vector3d center = (T_cam_body * vectorOf(sight.car.box_center_body_m).homogeneous()).head<3>();
    // The truth is of the middle of the footprint. Three sigmas of a disparity of 12 px are 2 m.
    EXPECT_LT((center - sight.T_cam_car.topRightCorner<3, 1>()).norm(), 2.5);
  });
}

TEST_F(CarAhead, IsACarOfACarsSize) {
  forEachSight([](const Sight& sight) {
    EXPECT_LT((vectorOf(sight.car.box_size_m) - Eigen::Vector3d(4.2, 1.75, 1.55)).norm(), 1);  // any car's
    EXPECT_THAT(sight.car.box_size_sigma_m, testing::Each(testing::Gt(0)));
    EXPECT_THAT(sight.car.box_center_sigma_m, testing::Each(testing::Gt(0)));
    EXPECT_EQ(sight.car.kind, Result::Kind::kCar);
    EXPECT_GT(sight.car.kind_probability, 0.5);
    EXPECT_LE(sight.car.kind_probability, 1);
  });
}

TEST_F(CarAhead, IsThereMoreAndMoreSurely) {
  forEachSight([](const Sight& sight) {
    EXPECT_GE(sight.car.existence_probability, 0.5);  // less likely ones are left out
    EXPECT_LE(sight.car.existence_probability, 1);
  });
  EXPECT_GT(results_.back().objects.front().existence_probability, 0.9);
}

TEST_F(CarAhead, KeepsItsNumberAndAges) {
  double age_s = -kPeriod_s;
  forEachSight([&](const Sight& sight) {
    EXPECT_EQ(sight.car.id, results_.back().objects.front().id);
    EXPECT_NEAR(sight.car.age_s, age_s + kPeriod_s, 1e-9);
    age_s = sight.car.age_s;
  });
}

TEST_F(CarAhead, IsInTheImageWhereBoxAndMaskTell) {
  int masks = 0;
  forEachSight([&](const Sight& sight) {
    const Eigen::Vector3d at = (sight.T_cam_car * Eigen::Vector4d(0, 0, 0.8, 1)).head<3>();  // its middle
    const double u_px = drive_.camera.fx_px * at.x() / at.z() + drive_.camera.cx_px,
                 v_px = drive_.camera.fy_px * at.y() / at.z() + drive_.camera.cy_px;
    const auto [left, top, right, bottom] = sight.car.image_box_px;
    EXPECT_TRUE(left < u_px && u_px < right && top < v_px && v_px < bottom);
    EXPECT_TRUE(0 <= left && right < drive_.camera.width_px && 0 <= top && bottom < drive_.camera.height_px);
    if (!sight.car.mask) return;
    const Result::Mask& mask = *sight.car.mask;
    const int column = (static_cast<int>(u_px) - mask.left_px) / mask.cell_px,
              row = (static_cast<int>(v_px) - mask.top_px) / mask.cell_px;
    ASSERT_TRUE(column >= 0 && column < mask.width_cells && row >= 0 && row < mask.height_cells);
    ASSERT_EQ(mask.inside.size(),
              static_cast<std::size_t>(mask.width_cells) * static_cast<std::size_t>(mask.height_cells));
    EXPECT_EQ(mask.inside[static_cast<std::size_t>(row * mask.width_cells + column)], 1);
    EXPECT_THAT(mask.inside, testing::Each(testing::Le(1)));
    ++masks;
  });
  EXPECT_GE(masks, 4);
}

TEST_F(CarAhead, HasAMaskOnlyOnRequest) {
  for (const Result& result : track(drive_))
    for (const Result::Object& object : result.objects) EXPECT_FALSE(object.mask);
}

}  // namespace
}  // namespace motorcade
