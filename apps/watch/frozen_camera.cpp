#include "apps/watch/frozen_camera.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

namespace motorcade {

std::optional<FrozenCamera::Side> FrozenCamera::observe(const StereoFrame& pair) {
  constexpr double kMost = 0.5;
  const double left = changedShare(pair.left, left_, pair.head.frame),
               right = changedShare(pair.right, right_, pair.head.frame);
  left_.repeated = left == 0 && right > kMost ? left_.repeated + 1 : 0;
  right_.repeated = right == 0 && left > kMost ? right_.repeated + 1 : 0;
  for (const Camera* const camera : {&left_, &right_})
    if (camera->repeated == kPairs && hasContent(*camera)) return Side{camera->name, camera->since};
  return std::nullopt;
}

/// Share of the sampled pixels that differ from those of the pair before; all of them in the first pair. Remembers the
/// image.
double FrozenCamera::changedShare(const Image& image, Camera& camera, FrameId frame) {
  constexpr int kStep_px = 8;
  std::vector<std::uint8_t> rows;
  rows.reserve(static_cast<std::size_t>(image.width()) * (image.height() / kStep_px + 1));
  for (int y = kStep_px / 2; y < image.height(); y += kStep_px)
    rows.insert(rows.end(), image.row(y), image.row(y) + image.width());
  const std::vector<std::uint8_t> before = std::exchange(camera.rows, std::move(rows));
  if (before == camera.rows) return 0;
  camera.since = frame;
  if (before.size() != camera.rows.size()) return 1;
  const auto changed = std::transform_reduce(before.begin(), before.end(), camera.rows.begin(), std::size_t{0},
                                             std::plus(), std::not_equal_to());
  return static_cast<double>(changed) / static_cast<double>(before.size());
}

bool FrozenCamera::hasContent(const Camera& camera) {
  constexpr int kContrast = 16;  // gray levels
  const auto [darkest, brightest] = std::ranges::minmax(camera.rows);
  return brightest - darkest >= kContrast;
}

Finding findingOf(const FrozenCamera::Side& side) {
  return {"frozen",
          "the " + side.name +
              " camera hangs: its image repeats to the bit while the other changes; look at its driver, or for copied "
              "files",
          true};
}

}  // namespace motorcade
