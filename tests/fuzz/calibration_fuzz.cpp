#include <array>
#include <cmath>

#include "io/sequence/calibration.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// A calibration, and the cameras that it gives.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  constexpr std::array<std::string_view, 4> kNoLine{"is missing", "has no P0 and P1", "has no P2 and P3",
                                                    "is no calibration that is read"};
  const auto& path = file.holding(fuzz::textOf(data, size));
  for (const CameraPair pair : {CameraPair::kGray, CameraPair::kColor}) {
    fuzz::readOrRefuse(path.native(), kNoLine, [&] {
      const Calibration calibration = readCalibration(path);
      const StereoCamera camera = calibration.stereoCamera(pair);
      for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.baseline_m})
        fuzz::require(std::isfinite(value), "a camera that is not finite");
      fuzz::require(std::isfinite(calibration.rightMiddle_px(pair)), "a middle that is not finite");
      fuzz::require(calibration.T_left_cam0(pair).translation().allFinite(), "a place that is not finite");
      if (const auto T_cam0_imu = calibration.T_cam0_imu()) {
        fuzz::require(T_cam0_imu->rotation().allFinite(), "an attitude that is not finite");
        fuzz::require(T_cam0_imu->translation().allFinite(), "a place that is not finite");
      }
    });
  }
  return 0;
}
