#include "apps/interface/pair_input.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"

namespace motorcade {
namespace {

/// A blank pair with random labels in the caller's memory, rows apart and at odd addresses.
class PairInputs : public testing::Test {
 protected:
  static constexpr int kSide_px = 64, kStride_bytes = 2 * kSide_px + 3, kAllBits = 16;

  Pair labelled(Pair::Format format) {
    std::generate(bytes_.begin(), bytes_.end(), [&] { return static_cast<std::uint8_t>(random_()); });
    Pair pair = drive_.pair(0);
    pair.instances = {.pixels = bytes_.data(),
                      .width_px = kSide_px,
                      .height_px = kSide_px,
                      .stride_bytes = kStride_bytes,
                      .format = format};
    return pair;
  }
  std::uint16_t given(int x, int y, Pair::Format format) const {
    const std::uint8_t* row = bytes_.data() + std::ptrdiff_t{y} * kStride_bytes;
    if (format == Pair::Format::kGray8) return row[x];
    return static_cast<std::uint16_t>(row[2 * x] + 256 * row[2 * x + 1]);  // little-endian
  }
  void expectTaken(const InstanceLabels& labels, Pair::Format format) const {
    ASSERT_EQ(labels.width(), kSide_px);
    ASSERT_EQ(labels.height(), kSide_px);
    for (int y = 0; y < kSide_px; ++y)
      for (int x = 0; x < kSide_px; ++x) ASSERT_EQ(labels.row(y)[x], given(x, y, format)) << x << ", " << y;
  }

  DriveInMemory drive_ = blankDrive(1);
  std::mt19937 random_{7};
  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(std::size_t{kStride_bytes} * kSide_px);
};

TEST_F(PairInputs, LabelsOfEightAndSixteenBitsAreCopied) {
  const CameraModel model(drive_.camera);
  for (const auto policy : {Tracker::Policy::kLive, Tracker::Policy::kReplay}) {
    PairInput input(drive_.camera, model, policy);
    for (const auto format : {Pair::Format::kGray8, Pair::Format::kGray16}) {
      const Pair pair = labelled(format);
      ASSERT_EQ(input.problemWith(pair), nullptr);
      const StereoFrame frame = input.frameOf(pair, kAllBits);
      ASSERT_TRUE(frame.inputs.instances);
      expectTaken(*frame.inputs.instances, format);
    }
  }
}

TEST_F(PairInputs, LabelsWithoutAStrideHaveNoGaps) {
  const CameraModel model(drive_.camera);
  PairInput input(drive_.camera, model, Tracker::Policy::kReplay);
  Pair pair = labelled(Pair::Format::kGray8);
  pair.instances.stride_bytes = 0;
  const StereoFrame frame = input.frameOf(pair, kAllBits);
  EXPECT_EQ(frame.inputs.instances->row(1)[0], bytes_[kSide_px]);
}

TEST_F(PairInputs, LabelsAreOfTheirPairAlone) {
  const CameraModel model(drive_.camera);
  PairInput input(drive_.camera, model, Tracker::Policy::kLive);
  const StereoFrame first = input.frameOf(labelled(Pair::Format::kGray8), kAllBits);
  const auto before = bytes_;
  EXPECT_EQ(input.frameOf(drive_.pair(0), kAllBits).inputs.instances, nullptr);
  const StereoFrame third = input.frameOf(labelled(Pair::Format::kGray8), kAllBits);
  expectTaken(*third.inputs.instances, Pair::Format::kGray8);
  bytes_ = before;
  expectTaken(*first.inputs.instances, Pair::Format::kGray8);
}

/// Labels are of the rectified image, unlike the images beside them.
TEST_F(PairInputs, LabelsOfARigStayWhereTheyAre) {
  Camera::Lens lens{.fx_px = 60,
                    .fy_px = 60,
                    .cx_px = 32,
                    .cy_px = 32,
                    .distortion = Camera::Distortion::kRadialTangential,
                    .coefficients = {-0.05, 0.01}};
  drive_.camera.rig = Camera::Rig{.left = lens, .right = lens, .T_right_left = {1, 0, 0, -0.5, 0, 1, 0, 0, 0, 0, 1, 0}};
  const CameraModel model(drive_.camera);
  PairInput input(drive_.camera, model, Tracker::Policy::kReplay);
  const StereoFrame frame = input.frameOf(labelled(Pair::Format::kGray16), kAllBits);
  ASSERT_EQ(model.rectified().width_px, kSide_px);
  expectTaken(*frame.inputs.instances, Pair::Format::kGray16);
}

TEST_F(PairInputs, LabelsComeBesideIgnoredPixels) {
  drive_.camera.ignored.bottom_px = 10;
  const CameraModel model(drive_.camera);
  PairInput input(drive_.camera, model, Tracker::Policy::kReplay);
  const StereoFrame frame = input.frameOf(labelled(Pair::Format::kGray8), kAllBits);
  EXPECT_TRUE(frame.inputs.ignored);
  EXPECT_TRUE(frame.inputs.instances);
}

}  // namespace
}  // namespace motorcade
