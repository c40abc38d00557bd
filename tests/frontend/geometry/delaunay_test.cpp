#include "frontend/geometry/delaunay.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/empty_circle.hpp"

namespace motorcade {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using test::Grid;
using test::onGrid;
using test::turn;
using test::Whole;

/// Twice the area of the convex hull, by gift wrapping over all pairs.
Whole hullAreaTwice(const std::vector<Grid>& points) {
  Whole area = 0;
  for (const Grid& a : points) {
    for (const Grid& b : points) {
      if (a.x == b.x && a.y == b.y) continue;
      const bool edge = std::ranges::all_of(points, [&](const Grid& c) {
        const Whole side = turn(a, b, c);
        const bool between = (c.x - a.x) * (b.x - c.x) + (c.y - a.y) * (b.y - c.y) >= 0;
        return side > 0 || (side == 0 && between);
      });
      if (edge) area += a.x * b.y - a.y * b.x;
    }
  }
  return area;
}

/// Every property of a Delaunay triangulation, checked by brute force.
void expectDelaunay(const Points& points_px, const DelaunayGraph& graph) {
  ASSERT_EQ(graph.vertex_of_point.size(), points_px.size());
  std::vector<Grid> position;
  for (const auto& p : points_px) position.push_back(onGrid(p));
  std::set<int> vertices(graph.vertex_of_point.begin(), graph.vertex_of_point.end());
  std::vector<Grid> distinct;
  for (const int v : vertices) distinct.push_back(position[v]);
  for (std::size_t i = 0; i < points_px.size(); ++i) {
    const int v = graph.vertex_of_point[i];
    EXPECT_LE(v, static_cast<int>(i));
    EXPECT_TRUE(position[v].x == position[i].x && position[v].y == position[i].y);
  }
  EXPECT_TRUE(std::ranges::is_sorted(graph.edges));
  EXPECT_TRUE(std::ranges::adjacent_find(graph.edges) == graph.edges.end());

  Whole area = 0;
  std::map<std::array<int, 2>, int> triangles_at;
  for (const auto& t : graph.triangles) {
    const Grid a = position[t[0]], b = position[t[1]], c = position[t[2]];
    ASSERT_GT(turn(a, b, c), 0);
    area += turn(a, b, c);
    for (const Grid& d : distinct) ASSERT_LE(circleSide(a, b, c, d), 0);
    for (int k = 0; k < 3; ++k) ++triangles_at[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  }
  for (const auto& edge : graph.edges) {
    EXPECT_LT(edge[0], edge[1]);
    EXPECT_TRUE(vertices.contains(edge[0]) && vertices.contains(edge[1]));
    EXPECT_LE(triangles_at[edge], 2);
    EXPECT_TRUE(graph.triangles.empty() || triangles_at[edge] >= 1);
  }
  // No triangle has an edge that is not listed.
  EXPECT_TRUE(graph.triangles.empty() || triangles_at.size() == graph.edges.size());
  // The triangles cover the hull: empty circles make sure that they do not overlap.
  EXPECT_EQ(area, hullAreaTwice(distinct));
  const auto euler = static_cast<int>(vertices.size()) - static_cast<int>(graph.edges.size()) +
                     static_cast<int>(graph.triangles.size());
  EXPECT_EQ(euler, 1);  // without the outer face; a chain too
}

Points roundedPoints(int count, unsigned seed, double step_px) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0, 400), v(0, 120);
  Points points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(std::round(u(random) / step_px) * step_px, std::round(v(random) / step_px) * step_px);
  return points;
}

TEST(Delaunay, RandomPointsHaveEmptyCircles) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Points points = roundedPoints(3 + 6 * static_cast<int>(seed), seed, 0.01);
    expectDelaunay(points, delaunay(points));
  }
}

TEST(Delaunay, WholePixelsWithDuplicatesAndCocircularPointsStayATriangulation) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Points points = roundedPoints(100, 100 + seed, 20);
    expectDelaunay(points, delaunay(points));
  }
}

TEST(Delaunay, AGridIsTriangulated) {
  Points points;
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x) points.emplace_back(5 * x, 5 * y);
  const DelaunayGraph graph = delaunay(points);
  expectDelaunay(points, graph);
  EXPECT_EQ(graph.triangles.size(), 2U * 8 * 6);
}

TEST(Delaunay, PointsOnACircleAreTriangulated) {
  const std::array<std::array<int, 2>, 12> circle{
      {{5, 0}, {4, 3}, {3, 4}, {0, 5}, {-3, 4}, {-4, 3}, {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}}};
  Points points;
  for (const auto& [x, y] : circle) points.emplace_back(100 + x, 100 + y);
  const DelaunayGraph graph = delaunay(points);
  expectDelaunay(points, graph);
  EXPECT_EQ(graph.triangles.size(), 10U);
}

TEST(Delaunay, CollinearPointsFormAChain) {
  const Points points{{30, 20}, {10, 10}, {50, 30}, {10, 10}, {70, 40}};
  const DelaunayGraph graph = delaunay(points);
  EXPECT_TRUE(graph.triangles.empty());
  const std::vector<std::array<int, 2>> chain{{0, 1}, {0, 2}, {2, 4}};
  EXPECT_EQ(graph.edges, chain);
  EXPECT_EQ(graph.vertex_of_point, (std::vector<int>{0, 1, 2, 1, 4}));
}

TEST(Delaunay, FewPointsGiveWhatTheyCan) {
  EXPECT_TRUE(delaunay({}).edges.empty());
  EXPECT_TRUE(delaunay(Points{{1, 2}}).edges.empty());
  EXPECT_TRUE(delaunay(Points{{1, 2}, {1.01, 2}}).edges.empty());  // the same sixteenth of a pixel
  EXPECT_EQ(delaunay(Points{{1, 2}, {3, 2}}).edges.size(), 1U);
  EXPECT_EQ(delaunay(Points{{1, 2}, {3, 2}, {2, 4}}).triangles.size(), 1U);
}

}  // namespace
}  // namespace motorcade
