#include "apps/watch/frozen_camera.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

namespace motorcade {

std::optional<FrozenCamera::Side> FrozenCamera::observe(const StereoFrame& pair) {
  constexpr double kMost = 0.5;
  const bool left = repeats(pair.left, left_, pair.head.frame), right = repeats(pair.right, right_, pair.head.frame);
  left_.repeated = left && !right && changedShare(right_) > kMost ? left_.repeated + 1 : 0;
  right_.repeated = right && !left && changedShare(left_) > kMost ? right_.repeated + 1 : 0;
  for (const Camera* const camera : {&left_, &right_})
    if (camera->repeated == kPairs && hasContent(*camera)) return Side{camera->name, camera->since};
  return std::nullopt;
}

/// Remembers the image; true if it is that of the pair before.
bool FrozenCamera::repeats(const Image& image, Camera& camera, FrameId frame) {
  constexpr int kStep_px = 32;
  std::swap(camera.rows, camera.before);
  camera.rows.clear();
  for (int y = kStep_px / 2; y < image.height(); y += kStep_px)
    camera.rows.insert(camera.rows.end(), image.row(y), image.row(y) + image.width());
  const bool same = camera.rows == camera.before;
  if (!same) camera.since = frame;
  return same;
}

/// Share of the remembered pixels that differ from those of the pair before.
double FrozenCamera::changedShare(const Camera& camera) {
  if (camera.before.size() != camera.rows.size()) return 1;
  const auto changed = std::transform_reduce(camera.before.begin(), camera.before.end(), camera.rows.begin(),
                                             std::size_t{0}, std::plus(), std::not_equal_to());
  return static_cast<double>(changed) / static_cast<double>(camera.rows.size());
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
