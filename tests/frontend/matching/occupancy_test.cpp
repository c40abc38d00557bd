#include "frontend/matching/occupancy.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kOccupancyWidth_px = 120, kOccupancyHeight_px = 70;
constexpr double kDistance_px = 5;

struct Point {
  float u_px, v_px;
};

/// Takes random points that are not near others, as the flow does.
TEST(Occupancy, KeepsPointsApartAndNoneAwayWithoutReason) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> u(0, kOccupancyWidth_px), v(0, kOccupancyHeight_px);
  Occupancy occupancy(kOccupancyWidth_px, kOccupancyHeight_px, kDistance_px);
  std::vector<Point> taken;
  for (int i = 0; i < 3000; ++i) {
    const Point p{u(random), v(random)};
    bool expected = false;
    for (const Point& q : taken) expected |= std::hypot(p.u_px - q.u_px, p.v_px - q.v_px) < kDistance_px;
    const bool near = occupancy.near(p.u_px, p.v_px);
    EXPECT_LE(near, expected);
    // A cell remembers its last point only. Two points 5 px apart fit in one cell just along its diagonal.
    if (taken.size() < 20) {
      EXPECT_EQ(near, expected);
    }
    if (near) continue;
    occupancy.take(p.u_px, p.v_px);
    taken.push_back(p);
  }
  EXPECT_GT(taken.size(), 180U);  // random packing of discs fills half of the area
}

TEST(Occupancy, LooksIntoNeighboringCellsUpToTheBorder) {
  for (const Point p : {Point{0, 0}, Point{kOccupancyWidth_px - 1, 0}, Point{0, kOccupancyHeight_px - 1},
                        Point{kOccupancyWidth_px - 1, kOccupancyHeight_px - 1}}) {
    Occupancy occupancy(kOccupancyWidth_px, kOccupancyHeight_px, kDistance_px);
    EXPECT_FALSE(occupancy.near(p.u_px, p.v_px));
    occupancy.take(p.u_px, p.v_px);
    const float inwards_u = p.u_px > 0 ? -1 : 1, inwards_v = p.v_px > 0 ? -1 : 1;
    EXPECT_TRUE(occupancy.near(p.u_px + 4.9F * inwards_u, p.v_px));
    EXPECT_TRUE(occupancy.near(p.u_px, p.v_px + 4.9F * inwards_v));
    EXPECT_FALSE(occupancy.near(p.u_px + 5.1F * inwards_u, p.v_px));
    EXPECT_FALSE(occupancy.near(p.u_px + 4 * inwards_u, p.v_px + 4 * inwards_v));
  }
}

}  // namespace
}  // namespace motorcade
