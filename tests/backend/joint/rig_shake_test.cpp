#include "backend/joint/rig_shake.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

/// Landmarks that tell the shake of each of ten frames with so much noise, as a posterior of the deviation known so
/// far.
void tell(RigShake& shake, int frames, double truth_px, double noise_px, test::Noise& noise) {
  constexpr int kBundle_frames = 10;
  std::vector<double> seen_px(frames);
  for (double& px : seen_px) px = noise.gaussian(std::hypot(truth_px, noise_px));
  for (int newest = kBundle_frames; newest < frames; ++newest) {
    std::vector<FrameId> ids;
    std::vector<FrameShake> shakes;
    const double sigma = shake.sigma_px(), variance = 1 / (1 / (sigma * sigma) + 1 / (noise_px * noise_px));
    const double without_mean = 1 - 1.0 / kBundle_frames;
    for (int frame = newest - kBundle_frames; frame < newest; ++frame) {
      ids.push_back({frame});
      const double px = seen_px[frame] * variance / (noise_px * noise_px);
      shakes.push_back({std::sqrt(without_mean) * px, without_mean * variance});
    }
    shake.observe(ids, shakes);
  }
}

TEST(RigShake, FindsItsDeviation) {
  for (const double truth_px : {0.015, 0.03, 0.1}) {
    test::Noise noise(1);
    RigShake shake(0.03);
    tell(shake, 200, truth_px, 0.01, noise);
    EXPECT_NEAR(shake.sigma_px(), truth_px, 0.2 * truth_px);
  }
}

TEST(RigShake, FindsThatThereIsNone) {
  test::Noise noise(2);
  RigShake shake(0.03);
  tell(shake, 200, 0, 0.01, noise);
  EXPECT_LT(shake.sigma_px(), 0.01);
}

TEST(RigShake, IsTakenAsItWasSaidUntilItIsSeen) {
  EXPECT_DOUBLE_EQ(RigShake(0.03).sigma_px(), 0.03);
  EXPECT_EQ(RigShake(0).sigma_px(), 0);
}

TEST(RigShake, ADamagedPairHardlyCounts) {
  test::Noise noise(3);
  RigShake shake(0.03);
  tell(shake, 200, 0.03, 0.01, noise);
  const double before_px = shake.sigma_px(), variance_px2 = 1e-4;
  std::vector<FrameId> frames;
  for (int frame = 300; frame < 304; ++frame) frames.push_back({frame});
  shake.observe(frames, std::vector(4, FrameShake{5, variance_px2 / 2}));
  EXPECT_LT(shake.sigma_px(), 1.1 * before_px);
}

TEST(RigShake, IsToldOfTheFramesThatItKnows) {
  RigShake shake(0.03);
  const std::vector<FrameId> frames{{4}, {5}, {6}};
  shake.observe(std::span(frames).first(2), std::vector<FrameShake>{{0.02, 1e-4}, {-0.05, 1e-4}});
  EXPECT_THAT(shake.px(frames), testing::ElementsAre(0.02, -0.05, 0));
  shake.forget({4});
  EXPECT_THAT(shake.px(frames), testing::ElementsAre(0, -0.05, 0));
}

/// Seen from later frames, few landmarks are left of a frame.
TEST(RigShake, StaysAsItIsOnceItIsLearnedFrom) {
  RigShake shake(0.03);
  std::vector<FrameId> frames;
  for (int frame = 0; frame < 6; ++frame) frames.push_back({frame});
  shake.observe(frames, std::vector(6, FrameShake{0.02, 1e-4}));
  shake.observe(frames, std::vector(6, FrameShake{0.05, 1e-4}));
  EXPECT_THAT(shake.px(frames), testing::ElementsAre(0.02, 0.02, 0.02, 0.05, 0.05, 0.05));
}

}  // namespace
}  // namespace motorcade
