#include "apps/evaluate/comparison/object_matching.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

/// A van ahead and a parked car four meters before it; a row on the van, whose body's origin lies at the van's front,
/// nearer to the parked car.
struct VanBehindACar {
  static constexpr double kVan_m = 32, kCar_m = 26, kOrigin_m = 28;
  CameraTruth camera{.T_world_cam = {SE3{}}, .source = ""};
  ObjectTruths truths;
  RunFolder::Trajectories run{.camera = {SE3{}}, .objects = {}};

  VanBehindACar() {
    for (const double z_m : {kCar_m, kVan_m}) {
      ObjectTruth truth;
      truth.frame = {0};
      truth.id = static_cast<std::int64_t>(truths.objects.size());
      truth.type = "Van";
      truth.T_cam_object = truth.T_world_object = SE3(Eigen::Matrix3d::Identity(), {0, 1.6, z_m});
      truth.size_m = {2, 1.8, 5};
      truths.objects.push_back(truth);
    }
    ObjectEstimate row;
    row.T_world_body = SE3(Eigen::Matrix3d::Identity(), {0, 1, kOrigin_m});
    run.objects.push_back({{0}, row});
  }
  int matched() const { return compareFrames(run, 0, camera, &truths, {Timestamp{}}).front().rows.front().object; }
};

TEST(ObjectMatching, ARowLiesWhereItsCuboidDoes) {
  VanBehindACar scene;
  EXPECT_EQ(scene.matched(), 0);  // the body's origin alone
  scene.run.objects.front().object.cuboid.emplace().center_body = {0, 0, VanBehindACar::kVan_m - 28};
  EXPECT_EQ(scene.matched(), 1);
  scene.run.objects.front().object.cuboid->center_body.z() = 40;
  EXPECT_EQ(scene.matched(), -1);
}

}  // namespace
}  // namespace motorcade
