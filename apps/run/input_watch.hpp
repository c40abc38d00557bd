#pragma once

#include "apps/check/input_check.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Looks at the first pairs of a run as they enter, and logs what is wrong with them, once.
class InputWatch {
 public:
  /// With `force` the run goes on where its results would be worthless.
  InputWatch(const StereoCamera& camera, bool force) : check_(camera, true), force_(force) {}

  /// Takes the pairs in order; false from when it is known that results would be worthless.
  bool admits(const StereoFrame& pair);
  /// After the last pair, which may come before enough were seen.
  void finish();
  /// The run was, or should have been, ended.
  bool refused() const { return refused_; }

 private:
  void tell();

  InputCheck check_;
  bool force_;
  bool told_ = false, refused_ = false;
};

}  // namespace motorcade
