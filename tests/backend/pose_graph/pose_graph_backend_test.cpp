#include "backend/pose_graph/pose_graph_backend.hpp"

#include <gtest/gtest.h>

#include "backend/filter/filter_backend.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::PointDrive;

struct Errors {
  double position_m = 0, step_m = 0;
};

/// Mean over some drives.
template <class MakeBackend>
Errors errorsOf(const MakeBackend& make) {
  constexpr int kSeeds = 5;
  Errors errors;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PointDrive drive(seed, {.drive = {.odometry_sigma_m = 0.005, .odometry_sigma_rad = 0.0002}});
    const auto backend = make();
    const auto finals = test::runDrive(*backend, drive).finals;
    errors.position_m += test::objectError_m(finals, drive.truth()) / kSeeds;
    errors.step_m += test::stepError_m(finals, drive.truth()) / kSeeds;
  }
  return errors;
}
Errors errorsOf(const PoseGraphBackend::Params& params, const WindowParams& window = {}) {
  return errorsOf([&] { return std::make_unique<PoseGraphBackend>(params, kPointRig, window); });
}

TEST(PoseGraphBackend, IsBetterThanTheFilterOfFrameToFramePoses) {
  const Errors graph = errorsOf(PoseGraphBackend::Params{});
  const Errors filter = errorsOf([] { return std::make_unique<FilterBackend>(FilterBackend::Params{}, kPointRig); });
  std::cout << "position, step: graph " << graph.position_m << " " << graph.step_m << " m, filter " << filter.position_m
            << " " << filter.step_m << " m\n";
  EXPECT_LT(graph.position_m, 0.7 * filter.position_m);
  EXPECT_LT(graph.step_m, 0.8 * filter.step_m);
  EXPECT_LT(filter.position_m, 2.0);  // it drifts, but it follows: vehicles are 15 to 70 m away
  EXPECT_LT(filter.step_m, 0.2);
}

TEST(PoseGraphBackend, EachKindOfFactorMakesItBetter) {
  const Errors all = errorsOf(PoseGraphBackend::Params{});
  const Errors rough = errorsOf({}, {.use_smoothness = false}), adrift = errorsOf({.use_camera_encounter = false});
  std::cout << "position, step: all " << all.position_m << " " << all.step_m << ", without smoothness "
            << rough.position_m << " " << rough.step_m << ", without encounters " << adrift.position_m << " "
            << adrift.step_m << "\n";
  EXPECT_LT(all.step_m, 0.7 * rough.step_m);
  EXPECT_LT(all.position_m, 0.7 * adrift.position_m);
}

}  // namespace
}  // namespace motorcade
