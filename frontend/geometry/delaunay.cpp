#include "frontend/geometry/delaunay.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace motorcade {
namespace {

__extension__ using Wide = __int128;

/// Position in 1/16 px. Differences stay below 2^30, so that products of two fit 64 bits and of four 128.
struct GridPoint {
  std::int64_t x, y;
  bool operator==(const GridPoint&) const = default;
  bool operator<(const GridPoint& other) const { return std::tie(x, y) < std::tie(other.x, other.y); }
};

GridPoint quantized(const Eigen::Vector2d& p_px) {
  constexpr double kPerPixel = 16;
  assert(p_px.cwiseAbs().maxCoeff() < double{1 << 24});
  return {std::llround(p_px.x() * kPerPixel), std::llround(p_px.y() * kPerPixel)};
}

/// Positive when a, b, c turn left (x right, y up).
std::int64_t orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// True when d lies strictly inside the circle through a, b, c, which turn left.
bool inCircle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const auto ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  const Wide lift_a = ax * ax + ay * ay, lift_b = bx * bx + by * by, lift_c = cx * cx + cy * cy;
  return lift_a * (bx * cy - by * cx) + lift_b * (cx * ay - cy * ax) + lift_c * (ax * by - ay * bx) > 0;
}

/// Edges as pairs of half-edges (Guibas, Stolfi 1985, without the dual): half-edge e and its reverse e ^ 1. The
/// half-edges that leave a vertex form a ring, `next` counter-clockwise and `previous` clockwise.
class EdgeRings {
 public:
  struct HalfEdge {
    int origin, next, previous;
  };

  /// Reserves edges for so many points: a triangulation has three per point, and some more are removed again.
  void reserve(std::size_t points) { edges_.reserve(8 * points); }
  int make(int from, int to) {
    const int e = size();
    edges_.push_back({from, e, e});
    edges_.push_back({to, e + 1, e + 1});
    return e;
  }
  /// Makes an edge from the end of a to the origin of b, with the same face to the left of all three.
  int connect(int a, int b) {
    const int e = make(destination(a), origin(b));
    splice(leftNext(a), e);
    splice(b, e ^ 1);
    return e;
  }
  void remove(int e) {
    splice(e, previous(e));
    splice(e ^ 1, previous(e ^ 1));
    edges_[e].origin = edges_[e ^ 1].origin = -1;
  }
  /// Joins the rings of a and b, or cuts them apart when they are one: b follows a.
  void splice(int a, int b) {
    const int after_a = next(a), after_b = next(b);
    edges_[a].next = after_b;
    edges_[b].next = after_a;
    edges_[after_b].previous = a;
    edges_[after_a].previous = b;
  }

  int size() const { return static_cast<int>(edges_.size()); }
  bool alive(int e) const { return origin(e) >= 0; }
  int origin(int e) const { return edges_[e].origin; }
  int destination(int e) const { return origin(e ^ 1); }
  int next(int e) const { return edges_[e].next; }
  int previous(int e) const { return edges_[e].previous; }
  int leftNext(int e) const { return previous(e ^ 1); }  // along the face on the left
  int rightBefore(int e) const { return next(e ^ 1); }   // towards e's end, along the face on the right

 private:
  std::vector<HalfEdge> edges_;
};

/// Triangulates distinct points, sorted by x, then y.
class Triangulator {
 public:
  explicit Triangulator(const std::vector<GridPoint>& points) : points_(points) {
    edges_.reserve(points.size());
    if (points.size() >= 2) triangulate(0, static_cast<int>(points.size()));
  }
  const EdgeRings& edges() const { return edges_; }
  bool turnsLeft(int a, int b, int c) const { return orientation(at(a), at(b), at(c)) > 0; }

 private:
  /// Hull edges: counter-clockwise out of the leftmost vertex, clockwise out of the rightmost.
  struct Hull {
    int left, right;
  };

  const GridPoint& at(int i) const { return points_[i]; }
  bool rightOf(int p, int e) const { return turnsLeft(p, edges_.destination(e), edges_.origin(e)); }
  bool leftOf(int p, int e) const { return turnsLeft(p, edges_.origin(e), edges_.destination(e)); }

  Hull triangulate(int first, int end) {
    if (end - first == 2) {
      const int e = edges_.make(first, first + 1);
      return {e, e ^ 1};
    }
    if (end - first == 3) return triangulateThree(first);
    const int middle = (first + end) / 2;
    const Hull left = triangulate(first, middle), right = triangulate(middle, end);
    return merge(left, right);
  }

  Hull triangulateThree(int first) {
    const int a = edges_.make(first, first + 1), b = edges_.make(first + 1, first + 2);
    edges_.splice(a ^ 1, b);
    const std::int64_t turn = orientation(at(first), at(first + 1), at(first + 2));
    if (turn == 0) return {a, b ^ 1};
    const int c = edges_.connect(b, a);
    if (turn > 0) return {a, b ^ 1};
    return {c ^ 1, c};
  }

  /// Sews two neighboring triangulations together from the lower common tangent up.
  Hull merge(Hull left, Hull right) {
    int inner_left = left.right, inner_right = right.left;
    for (;;) {
      if (leftOf(edges_.origin(inner_right), inner_left)) {
        inner_left = edges_.leftNext(inner_left);
      } else if (rightOf(edges_.origin(inner_left), inner_right)) {
        inner_right = edges_.rightBefore(inner_right);
      } else {
        break;
      }
    }
    int base = edges_.connect(inner_right ^ 1, inner_left);
    if (edges_.origin(inner_left) == edges_.origin(left.left)) left.left = base ^ 1;
    if (edges_.origin(inner_right) == edges_.origin(right.right)) right.right = base;
    for (;;) {
      const int candidate_left = clearedLeft(base), candidate_right = clearedRight(base);
      const bool left_valid = rightOf(edges_.destination(candidate_left), base);
      const bool right_valid = rightOf(edges_.destination(candidate_right), base);
      if (!left_valid && !right_valid) return {left.left, right.right};
      const bool take_right =
          !left_valid ||
          (right_valid && inCircle(at(edges_.destination(candidate_left)), at(edges_.origin(candidate_left)),
                                   at(edges_.origin(candidate_right)), at(edges_.destination(candidate_right))));
      base = take_right ? edges_.connect(candidate_right, base ^ 1) : edges_.connect(base ^ 1, candidate_left ^ 1);
    }
  }

  /// Returns the next edge upwards on the left of the seam (or on its right), after removing the edges that a better
  /// triangle replaces.
  int clearedLeft(int base) {
    int e = edges_.next(base ^ 1);
    while (rightOf(edges_.destination(e), base) &&
           inCircle(at(edges_.destination(base)), at(edges_.origin(base)), at(edges_.destination(e)),
                    at(edges_.destination(edges_.next(e))))) {
      const int following = edges_.next(e);
      edges_.remove(e);
      e = following;
    }
    return e;
  }
  int clearedRight(int base) {
    int e = edges_.previous(base);
    while (rightOf(edges_.destination(e), base) &&
           inCircle(at(edges_.destination(base)), at(edges_.origin(base)), at(edges_.destination(e)),
                    at(edges_.destination(edges_.previous(e))))) {
      const int following = edges_.previous(e);
      edges_.remove(e);
      e = following;
    }
    return e;
  }

  const std::vector<GridPoint>& points_;
  EdgeRings edges_;
};

/// Distinct positions with the index of the first point at each, sorted by position.
struct Vertices {
  std::vector<GridPoint> positions;
  std::vector<int> point;
};

Vertices mergeDuplicates(std::span<const Eigen::Vector2d> points_px, std::vector<int>& vertex_of_point) {
  std::vector<std::pair<GridPoint, int>> sorted;
  sorted.reserve(points_px.size());
  for (const auto& p_px : points_px) sorted.emplace_back(quantized(p_px), static_cast<int>(sorted.size()));
  std::ranges::sort(sorted);
  Vertices vertices;
  vertex_of_point.resize(points_px.size());
  for (const auto& [position, point] : sorted) {
    if (vertices.positions.empty() || vertices.positions.back() != position) {
      vertices.positions.push_back(position);
      vertices.point.push_back(point);
    }
    vertex_of_point[point] = vertices.point.back();
  }
  return vertices;
}

/// Rotates the three vertices so that the smallest comes first.
std::array<int, 3> smallestFirst(std::array<int, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

DelaunayGraph delaunay(std::span<const Eigen::Vector2d> points_px, bool with_triangles) {
  DelaunayGraph graph;
  const Vertices vertices = mergeDuplicates(points_px, graph.vertex_of_point);
  const auto point = [&](int vertex) { return vertices.point[vertex]; };
  const Triangulator triangulator(vertices.positions);
  const EdgeRings& edges = triangulator.edges();
  for (int e = 0; e < edges.size(); ++e) {
    if (!edges.alive(e)) continue;
    const int a = edges.origin(e), b = edges.destination(e);
    if (e % 2 == 0) graph.edges.push_back({std::min(point(a), point(b)), std::max(point(a), point(b))});
    if (!with_triangles) continue;
    const int second = edges.leftNext(e), third = edges.leftNext(second), c = edges.destination(second);
    const bool closed = edges.leftNext(third) == e && edges.destination(third) == a;
    if (closed && a < b && a < c && triangulator.turnsLeft(a, b, c))
      graph.triangles.push_back(smallestFirst({point(a), point(b), point(c)}));
  }
  std::ranges::sort(graph.edges);
  std::ranges::sort(graph.triangles);
  return graph;
}

}  // namespace motorcade
