#include "perf/apps/result_digest.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace motorcade::perf {
namespace {

/// FNV-1a over 64-bit words.
class Digest {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) value_ = (value_ ^ (word >> 8 * byte & 0xff)) * 0x100000001b3;
  }
  void add(std::int64_t number) { add(static_cast<std::uint64_t>(number)); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      for (Eigen::Index row = 0; row < matrix.rows(); ++row) add(matrix(row, column));
  }
  void add(const SE3& pose) {
    add(pose.rotation());
    add(pose.translation());
  }
  void add(const std::optional<Matrix6d>& covariance) {
    add(std::int64_t{covariance.has_value()});
    if (covariance) add(*covariance);
  }
  void add(const std::optional<ObjectAcceleration>& acceleration) {
    add(std::int64_t{acceleration.has_value()});
    if (!acceleration) return;
    const auto& [along_mps2, along_sigma_mps2, yaw_radps2, yaw_sigma_radps2] = *acceleration;
    for (const double value : {along_mps2, along_sigma_mps2, yaw_radps2, yaw_sigma_radps2}) add(value);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

std::size_t firstMismatch(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  const auto [at_a, at_b] = std::ranges::mismatch(a, b);
  if (at_a == a.end() && at_b == b.end()) return std::numeric_limits<std::size_t>::max();
  return static_cast<std::size_t>(at_a - a.begin());
}

}  // namespace

std::uint64_t digestOf(const FrameEstimate& estimate) {
  Digest digest;
  digest.add(estimate.head.frame.value);
  digest.add(estimate.head.stamp.ns);
  digest.add(static_cast<std::int64_t>(estimate.head.status));
  digest.add(estimate.T_world_cam);
  digest.add(estimate.camera_covariances.motion);
  digest.add(estimate.camera_covariances.pose);
  for (const ObjectEstimate& object : estimate.objects) {
    digest.add(object.track.value);
    digest.add(static_cast<std::int64_t>(object.state));
    digest.add(object.T_world_body);
    digest.add(object.velocity_world_mps);
    digest.add(object.speed_sigma_mps);
    digest.add(object.acceleration);
    digest.add(std::int64_t{object.points});
    for (const double edge_px : {object.box.left_px, object.box.top_px, object.box.right_px, object.box.bottom_px})
      digest.add(edge_px);
    digest.add(object.covariance);
  }
  return digest.value();
}

std::optional<std::size_t> firstDifference(const ResultDigests& a, const ResultDigests& b) {
  if (a == b) return std::nullopt;
  return std::min(firstMismatch(a.online, b.online), firstMismatch(a.final, b.final));
}

}  // namespace motorcade::perf
