#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "core/se3.hpp"

namespace motorcade {

/// A back-end that starts anew after an exception, which may have left it in the middle of an update. The frame is
/// lost. The last estimates of the frames in its window become their final ones. The new back-end starts at the
/// camera's pose by odometry.
class RestartingBackend final : public Backend {
 public:
  explicit RestartingBackend(std::function<std::unique_ptr<Backend>()> make);

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

 private:
  EstimatesPtr estimate(const FrameMeasurementsPtr& measurements);
  void moveToWorld(FrameEstimate& estimate) const;
  void giveUp(const FrameMeasurements& measurements) noexcept;

  std::function<std::unique_ptr<Backend>()> make_;
  std::unique_ptr<Backend> backend_;
  bool restarted_ = false;
  SE3 T_world_start_;                 // the world of this back-end begins with its first frame
  SE3 T_world_cam_;                   // of the last frame
  std::deque<FrameEstimate> window_;  // as published last, of frames that are not final
  std::deque<FrameEstimate> left_;    // by back-ends that were given up
};

}  // namespace motorcade
