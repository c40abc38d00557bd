#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/watch/frozen_camera.hpp"
#include "apps/watch/input_check.hpp"

namespace motorcade {

/// A fault of a drive's pairs. It began after `last_good`, which is none in the first pairs, and at the latest with
/// `first_bad`.
struct RigFinding {
  Finding finding;
  std::optional<FrameId> last_good;
  FrameId first_bad;

  /// A sentence for the log, which names the frames.
  std::string text() const;
};

/// Watches the pairs of a whole drive for a rig that is wrong, or becomes so. The first pairs are looked at as `check`
/// does. After them one pair in five gets a glance. If its rows disagree, the next twelve are looked at like the first.
/// A lasting change is found within twenty pairs. Call in the order of the frames.
class RigWatch {
 public:
  static constexpr int kGlanceEvery = 5;          // pairs; odd, as what is wrong may be so in every second pair
  static constexpr std::size_t kVerifiedBy = 12;  // pairs
  explicit RigWatch(const StereoCamera& camera) : camera_(camera), check_(std::in_place, camera) {}

  /// Returns the new findings if this pair completes a check: all for the first pairs, later only those on the rig. A
  /// camera that hangs is found at any time.
  std::vector<RigFinding> observe(const StereoFrame& pair);
  /// Judges an unfinished check after the last pair; fewer pairs than usual suffice.
  std::vector<RigFinding> finish();
  /// True from when results would be worthless, until the rows agree again.
  bool worthless() const { return worthless_; }

 private:
  std::optional<RigFinding> frozen(const StereoFrame& pair);
  void glance(const StereoFrame& pair);
  bool agrees(const StereoFrame& pair);
  std::vector<RigFinding> judge();

  StereoCamera camera_;
  ImagePool pool_;
  FrozenCamera frozen_camera_;
  bool started_ = false;             // the first pairs are judged
  std::optional<InputCheck> check_;  // while pairs are looked at one by one
  PairGeometry usual_;               // as the rig was when it was good
  std::optional<FrameId> last_good_;
  FrameId first_bad_;                                          // of the glance that led to looking
  int until_glance_ = kGlanceEvery, patience_ = kGlanceEvery;  // pairs
  int agreeing_ = 0;                                           // glances in a row
  bool worthless_ = false;
  std::set<std::string> told_;
};

}  // namespace motorcade
