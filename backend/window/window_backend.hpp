#pragma once

#include <memory>
#include <vector>

#include "backend/backend.hpp"
#include "backend/window/window_params.hpp"

namespace motorcade {

class SmoothingWindow;

/// Publishes the estimates of a smoothing window: the newest frame at once, settled frames as they are, and final ones
/// when they leave the window.
class WindowBackend : public Backend {
 public:
  WindowBackend(std::unique_ptr<SmoothingWindow> window, const WindowParams& params);
  ~WindowBackend() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

 private:
  class Publisher;
  std::unique_ptr<Publisher> publisher_;
};

}  // namespace motorcade
