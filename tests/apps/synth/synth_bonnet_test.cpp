#include <gtest/gtest.h>

#include "apps/synth/output/ground_truth.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "tests/apps/synth/rendered_scene.hpp"

namespace motorcade::synth {
namespace {

constexpr float kBonnetEnd_m = 2.2F;  // nothing else comes so near

Rendering renderBonnet(int frame, StereoSide side) {
  const Scene scene = makeScene("bonnet", 1);
  return render(FrameScene(scene, frame, true), kSmallCamera, side, kNoNoise);
}
bool onBonnet(const Rendering& rendering, std::size_t i) {
  return rendering.depth_m[i] > 0 && rendering.depth_m[i] < kBonnetEnd_m;
}

TEST(SynthBonnet, StaysWhereItIsWhileItsReflectionPasses) {
  for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
    const Rendering before = renderBonnet(10, side), after = renderBonnet(50, side);
    const auto old_pixels = pixels(before.image), new_pixels = pixels(after.image);
    int covered = 0, changed = 0;
    for (std::size_t i = 0; i < old_pixels.size(); ++i) {
      ASSERT_EQ(onBonnet(before, i), onBonnet(after, i));
      if (!onBonnet(before, i)) continue;
      ASSERT_NEAR(before.depth_m[i], after.depth_m[i], 1e-3);  // single precision
      ++covered;
      changed += std::abs(old_pixels[i] - new_pixels[i]) > 3 ? 1 : 0;
    }
    EXPECT_GT(covered, static_cast<int>(old_pixels.size()) / 50);
    EXPECT_GT(changed, covered / 4);
  }
}

TEST(SynthBonnet, IsDarkAndOnlyInTheLowestRows) {
  const Rendering left = renderBonnet(10, StereoSide::kLeft);
  const auto levels = pixels(left.image);
  for (std::size_t i = 0; i < levels.size(); ++i)
    if (onBonnet(left, i)) {
      EXPECT_GT(i / kSmallCamera.width_px, 0.8 * kSmallCamera.height_px);
      EXPECT_LT(levels[i], 140);
    }
}

TEST(SynthBonnet, IsNoObject) {
  const Rendering left = renderBonnet(10, StereoSide::kLeft);
  for (std::size_t i = 0; i < left.object.size(); ++i) ASSERT_TRUE(!onBonnet(left, i) || left.object[i] == -1);
  const Scene scene = makeScene("bonnet", 1);
  const FrameScene frame(scene, 10, true);
  for (const auto& label : labelsOf(frame, kSmallCamera, left)) EXPECT_GT(label.location_cam.z(), 5);
}

}  // namespace
}  // namespace motorcade::synth
