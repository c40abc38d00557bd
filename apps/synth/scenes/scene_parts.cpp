#include "apps/synth/scenes/scene_parts.hpp"

namespace motorcade::synth {

PathPtr makePath(double x, double y, double heading_rad, std::vector<Path::Piece> pieces, bool closed) {
  return std::make_shared<const Path>(Eigen::Vector2d(x, y), heading_rad, std::move(pieces), closed);
}

PathPtr straight(double from_m, double to_m) { return makePath(from_m, 0, 0, {{to_m - from_m, 0}}); }

Trajectory drive(const PathPtr& path, double start_m, Profile speed_mps, Profile left_m, bool backwards) {
  Trajectory t;
  t.path = path;
  t.start_m = start_m;
  t.speed_mps = std::move(speed_mps);
  t.left_m = std::move(left_m);
  t.backwards = backwards;
  return t;
}

Road street(PathPtr path) { return {std::move(path), 5.7, {{0, 0.12, true}, {3.5, 0.12, false}, {-3.5, 0.12, false}}}; }

Road oneWay(PathPtr path, int lanes, double shoulder_m) {
  Road road{std::move(path), 0.5 * lanes * kLane_m + shoulder_m, {}};
  for (int i = 0; i <= lanes; ++i) road.lines.push_back({(i - 0.5 * lanes) * kLane_m, 0.14, i > 0 && i < lanes});
  return road;
}

Road avenue(PathPtr path) {
  constexpr double kParking_m = 2.2, kDouble_m = 0.14;
  Road road{std::move(path), 2 * kLane_m + kParking_m, {{-kDouble_m, 0.12, false}, {kDouble_m, 0.12, false}}};
  for (const double side : {-kLane_m, kLane_m}) {
    road.lines.push_back({side, 0.12, true});
    road.lines.push_back({2 * side, 0.12, false});
  }
  return road;
}

}  // namespace motorcade::synth
