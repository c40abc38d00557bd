#include "apps/evaluate/measures/acceleration_measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace motorcade {
namespace {

constexpr double kHalfSpan_s = 0.2, kStampTolerance_s = 0.01;

/// A label's poses by frame, and the motion computed from them.
class TruePath {
 public:
  explicit TruePath(const std::vector<Timestamp>& stamps) : stamps_(stamps) {}

  void add(FrameId frame, const SE3& T_world_object) { poses_[frame.value] = T_world_object; }

  struct Rates {
    double along = 0, yaw = 0;  // speed [m/s] and yaw rate [rad/s], or their derivatives
  };
  std::optional<Rates> acceleration(FrameId frame) const {
    std::int64_t from = frame.value, to = frame.value;
    while (from > 0 && secondsFrom(from - 1, frame.value) <= kHalfSpan_s + kStampTolerance_s) --from;
    while (to + 1 < std::ssize(stamps_) && secondsFrom(frame.value, to + 1) <= kHalfSpan_s + kStampTolerance_s) ++to;
    const auto before = motion(from), after = motion(to);
    if (from == frame.value || to == frame.value || !before || !after) return std::nullopt;
    const double span_s = secondsFrom(from, to);
    return Rates{.along = (after->along - before->along) / span_s, .yaw = (after->yaw - before->yaw) / span_s};
  }

 private:
  double secondsFrom(std::int64_t from, std::int64_t to) const { return secondsBetween(stamps_[from], stamps_[to]); }

  std::optional<Rates> motion(std::int64_t frame) const {
    const auto before = poses_.find(frame - 1), after = poses_.find(frame + 1);
    if (before == poses_.end() || after == poses_.end()) return std::nullopt;
    const double span_s = secondsFrom(frame - 1, frame + 1);
    if (!(span_s > 0)) return std::nullopt;
    const SE3 step = before->second.inverse() * after->second;  // in the label's axes, y down
    return Rates{.along = step.translation().norm() / span_s, .yaw = -logSO3(step.rotation()).y() / span_s};
  }

  const std::vector<Timestamp>& stamps_;
  std::map<std::int64_t, SE3> poses_;
};

std::map<std::int64_t, TruePath> truePaths(const std::vector<ComparedFrame>& frames,
                                           const std::vector<Timestamp>& stamps) {
  std::map<std::int64_t, TruePath> paths;
  for (const ComparedFrame& frame : frames)
    for (const TrueObject& object : frame.objects)
      paths.try_emplace(object.truth.id, stamps).first->second.add(frame.frame, object.truth.T_world_object);
  return paths;
}

/// Errors with the rows' standard deviations of them.
struct Samples {
  std::vector<double> errors;
  int covered = 0;

  void add(double error, double sigma) {
    errors.push_back(error);
    covered += std::abs(error) <= kSigmas95 * sigma;
  }
  CoveredErrors summary() && {
    const double coverage = covered / std::max(1.0, static_cast<double>(errors.size()));
    return {.errors = statisticsOf(std::move(errors)), .coverage = coverage};
  }
};

}  // namespace

AccelerationErrors accelerationErrors(const std::vector<ComparedFrame>& frames, const std::vector<Timestamp>& stamps) {
  const auto paths = truePaths(frames, stamps);
  const auto rows_before = rowsBefore(frames);
  AccelerationErrors result;
  Samples along, yaw;
  for (const auto& [frame, object, row] : askedPairs(frames)) {
    if (rows_before.at(row) < kEarlyRows) continue;
    const auto truth = paths.at(object->truth.id).acceleration(frame->frame);
    if (!truth) continue;
    ++result.rows;
    const auto& told = row->row.object.acceleration;
    if (!told) continue;
    along.add(told->along_mps2 - truth->along, told->along_sigma_mps2);
    yaw.add(told->yaw_radps2 - truth->yaw, told->yaw_sigma_radps2);
  }
  result.along_mps2 = std::move(along).summary();
  result.yaw_radps2 = std::move(yaw).summary();
  return result;
}

}  // namespace motorcade
