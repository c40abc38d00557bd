#include "frontend/segmentation/motion_graph.hpp"

#include <algorithm>
#include <queue>

#include <gtest/gtest.h>

#include "tests/support/empty_circle.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using Components = std::vector<std::vector<int>>;

Points onPixelGrid(int count, test::Noise& noise) {
  Points points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(std::round(noise.uniform(0, 16 * 500)) / 16, std::round(noise.uniform(0, 16 * 180)) / 16);
  return points;
}

/// Components by breadth-first search, in the order that the graph promises.
template <class Predicate>
Components search(int count, const std::set<std::array<int, 2>>& edges, const Predicate& together) {
  std::vector<bool> seen(static_cast<std::size_t>(count), false);
  Components components;
  for (int start = 0; start < count; ++start) {
    if (seen[start]) continue;
    std::vector<int> members;
    std::queue<int> open({start});
    seen[start] = true;
    while (!open.empty()) {
      const int i = open.front();
      open.pop();
      members.push_back(i);
      for (int j = 0; j < count; ++j) {
        if (seen[j] || !edges.contains({std::min(i, j), std::max(i, j)}) || !together(i, j)) continue;
        seen[j] = true;
        open.push(j);
      }
    }
    std::ranges::sort(members);
    components.push_back(members);
  }
  return components;
}

TEST(MotionGraph, ComponentsAreThoseOfTheTriangulationByItsDefinition) {
  int compared = 0, several = 0;
  for (std::uint64_t seed = 0; seed < 15; ++seed) {
    test::Noise noise(seed);
    const int count = 30 + 2 * static_cast<int>(seed);
    const Points points = onPixelGrid(count, noise);
    std::vector<test::Grid> grid;
    std::vector<double> speed;
    for (const auto& p : points) {
      grid.push_back(test::onGrid(p));
      speed.push_back(std::floor(p.x() / 100) + noise.uniform(0, 1.2));  // neighboring stripes sometimes touch
    }
    const auto edges = test::delaunayEdgesByDefinition(grid);
    if (!edges) continue;  // no unique triangulation to compare with
    const auto together = [&](int i, int j) { return std::abs(speed[i] - speed[j]) < 0.5; };
    const Components expected = search(count, *edges, together);
    EXPECT_EQ(cutDelaunayComponents(points, together), expected) << "seed " << seed;
    ++compared;
    several += expected.size() > 3 && expected.size() < points.size() / 2;
  }
  EXPECT_GE(compared, 10);  // degenerate draws are rare, ...
  EXPECT_GE(several, 5);    // ... and the predicate neither cuts nor keeps all
}

TEST(MotionGraph, AClusterBetweenOthersIsCutOutAndCoincidentPointsStayTogether) {
  const Points points{{10, 10}, {50, 10}, {50, 10}, {10, 40}, {52, 40}, {10, 10.01}, {90, 12}, {91, 41}};
  const std::vector<int> body{0, 1, 2, 0, 1, 3, 4, 4};  // points 2 and 5 lie at the pixel of another body
  const auto together = [&](int i, int j) { return body[i] == body[j]; };
  const Components expected{{0, 3, 5}, {1, 2, 4}, {6, 7}};
  EXPECT_EQ(cutDelaunayComponents(points, together), expected);
}

TEST(MotionGraph, NoPointsHaveNoComponents) {
  const auto never = [](int, int) { return false; };
  EXPECT_TRUE(cutDelaunayComponents({}, never).empty());
  EXPECT_EQ(cutDelaunayComponents(Points{{1, 1}, {5, 5}}, never).size(), 2U);
}

}  // namespace
}  // namespace motorcade
