#include <array>

#include "io/truth/ground_truth.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// Packets of the inertial unit, and the path of a camera that sits on it.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  constexpr std::array<std::string_view, 1> kNoLine{" frames, there are "};
  Sequence sequence;
  sequence.truth.oxts = file.holding(fuzz::textOf(data, size));
  sequence.calibration.R_rect = Eigen::Matrix3d::Identity();
  sequence.calibration.T_cam_velo = sequence.calibration.T_velo_imu = SE3{};
  sequence.frames.resize(1);
  fuzz::readOrRefuse(sequence.truth.oxts.native(), kNoLine, [&] {
    const auto truth = readCameraTruth(sequence);
    for (const SE3& T_world_cam : truth->T_world_cam)
      fuzz::require(T_world_cam.translation().allFinite(), "a place that is not finite");
  });
  return 0;
}
