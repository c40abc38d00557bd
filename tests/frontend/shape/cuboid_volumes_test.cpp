#include "frontend/shape/cuboid_volumes.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/shape/street_by_hand.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::StreetByHand;

constexpr PixelWindow kVolumeWindow{
    .u0 = 230, .v0 = 60, .width = 141, .height = 100};  // the last cells of a row fill no vector
constexpr int kVolumeLevel = 1;

class VolumesOfCar : public testing::Test {
 protected:
  VolumesOfCar() {
    FaceInformation sure;
    for (int face = 0; face < 6; ++face) sure.add(Vector6d::Unit(face), faces_[face], 0.1);
    view_.box = estimateBox(sure, {10});
  }
  std::vector<std::uint8_t> tell(std::uint8_t asked = CuboidVolumes::kPossible) const {
    std::vector<std::uint8_t> cells(kVolumeWindow.area(), asked);
    CuboidVolumes(seen_, view_, kRig).tell(CuboidVolumes::kDisparitySigma_px, cells);
    return cells;
  }
  /// Share of cells that are told so, of those that show the car well above the road, or of those that show something
  /// else.
  double share(const std::vector<std::uint8_t>& cells, bool of_car, std::uint8_t told) const {
    int all = 0, such = 0;
    for (int cell = 0; cell < kVolumeWindow.area(); ++cell) {
      const double u_px = seen_.u_px(cell % kVolumeWindow.width), v_px = seen_.v_px(cell / kVolumeWindow.width);
      const auto hit = street_.at(u_px, v_px);
      const double height_m = StreetByHand::kRoad_m - hit.depth_m * (v_px - kRig.cy_px) / kRig.fy_px;
      if ((hit.item == 0) != of_car || (of_car && height_m < 0.2)) continue;
      ++all, such += cells[cell] == told;
    }
    return static_cast<double>(such) / all;
  }

  SE3 T_cam_body_ = StreetByHand::standingAt(-0.3, 13, 0.4);
  BoxFaces faces_ = StreetByHand::faces({4.2, 1.8, 1.5});
  StreetByHand street_{{{T_cam_body_, faces_}}};
  LevelDisparities seen_ = street_.disparities(kVolumeWindow, kVolumeLevel);
  ObjectView view_{.T_cam_body = T_cam_body_,
                   .box = {},
                   .ground = {.normal_cam = {0, 1, 0}, .height_m = StreetByHand::kRoad_m},
                   .disparity_offset_px = 0};
};

TEST_F(VolumesOfCar, HoldItAndNotTheRoadOrTheWall) {
  EXPECT_EQ(share(tell(), true, CuboidVolumes::kUsual), 1);
  EXPECT_GT(share(tell(), false, CuboidVolumes::kOutside), 0.98);
}

TEST_F(VolumesOfCar, HoldNothingThatIsNotAskedForOrUnknown) {
  EXPECT_EQ(share(tell(CuboidVolumes::kOutside), true, CuboidVolumes::kOutside), 1);
  seen_.map.disparity_px.assign(kVolumeWindow.area(), DisparityMap::kNone);
  EXPECT_EQ(share(tell(), true, CuboidVolumes::kOutside), 1);
}

TEST_F(VolumesOfCar, LeaveOutWhatIsInAnothersCuboid) {
  const Eigen::Vector3d margin_m(0.1, 0.1, 0.1);
  view_.others.push_back({T_cam_body_.inverse(), Eigen::Vector3d(faces_[0], faces_[2], faces_[4]) - margin_m,
                          Eigen::Vector3d(faces_[1], faces_[3], faces_[5]) + margin_m});
  EXPECT_EQ(share(tell(), true, CuboidVolumes::kOutside), 1);
}

}  // namespace
}  // namespace motorcade
