#include "perf/backend/solver/street_grid.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace motorcade::perf {
namespace {

constexpr int kBlock_m = 5;            // between crossings
constexpr double kTurnShare = 0.4;     // of the crossings
constexpr double kPosesPerMeter2 = 4;  // so that a place is met about four times, as in city10000
constexpr double kSigma_m = 0.03, kSigma_rad = 0.02;

struct Place {
  int x = 0, y = 0;
  auto operator<=>(const Place&) const = default;
};
constexpr std::array<Place, 4> kHeadings{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

/// A driver who stays within a square of streets.
class Driver {
 public:
  Driver(int poses, std::uint64_t seed)
      : random_(seed),
        side_m_(kBlock_m *
                static_cast<int>(std::ceil(std::sqrt(poses / kPosesPerMeter2) * kShareOfStreets / kBlock_m))) {}

  SE2 pose() const { return {heading_ * std::numbers::pi / 2, {at_.x, at_.y}}; }
  Place place() const { return at_; }
  void drive() {
    if (at_.x % kBlock_m == 0 && at_.y % kBlock_m == 0) chooseHeading();
    at_ = ahead(heading_);
  }
  /// The motion from a to b as it is measured.
  SE2 measured(const SE2& a, const SE2& b) {
    const Eigen::Vector3d noise(kSigma_m * normal_(random_), kSigma_m * normal_(random_),
                                kSigma_rad * normal_(random_));
    return a.inverse() * b * SE2::exp(noise);
  }

 private:
  /// Meters of side per root of the streets' meters: a block of n x n meters has 2 n - 1 meters of streets.
  static constexpr double kShareOfStreets = 1.67;

  Place ahead(int heading) const { return {at_.x + kHeadings[heading].x, at_.y + kHeadings[heading].y}; }
  bool isInside(const Place& place) const {
    return place.x >= 0 && place.y >= 0 && place.x <= side_m_ && place.y <= side_m_;
  }
  void chooseHeading() {
    const bool turns = std::bernoulli_distribution(kTurnShare)(random_) || !isInside(ahead(heading_));
    if (!turns) return;
    const int left = (heading_ + 1) % 4, right = (heading_ + 3) % 4;
    const bool to_left = std::bernoulli_distribution(0.5)(random_);
    heading_ = to_left ? left : right;
    if (!isInside(ahead(heading_))) heading_ = to_left ? right : left;
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  int side_m_;
  Place at_;
  int heading_ = 0;
};

PoseGraph::Edge edgeOf(std::int64_t from, std::int64_t to, const SE2& measured) {
  const Eigen::Vector3d sigmas(kSigma_m, kSigma_m, kSigma_rad);
  return {.from = from,
          .to = to,
          .measured = measured,
          .information = Eigen::MatrixXd(sigmas.cwiseAbs2().cwiseInverse().asDiagonal())};
}

}  // namespace

PoseGraph streetGrid(int poses, std::uint64_t seed) {
  PoseGraph graph;
  graph.planar = true;
  Driver driver(poses, seed);
  std::map<Place, std::pair<std::int64_t, SE2>> last_at;
  SE2 before;
  for (std::int64_t id = 0; id < poses; ++id) {
    if (id > 0) driver.drive();
    const SE2 now = driver.pose();
    graph.poses.push_back(id);
    if (id > 0) graph.edges.push_back(edgeOf(id - 1, id, driver.measured(before, now)));
    const auto [seen, is_new] = last_at.try_emplace(driver.place(), id, now);
    if (!is_new) {
      graph.edges.push_back(edgeOf(seen->second.first, id, driver.measured(seen->second.second, now)));
      seen->second = {id, now};
    }
    before = now;
  }
  return graph;
}

}  // namespace motorcade::perf
