#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motorcade/motorcade.h"
#include "tests/interface/c_handles.hpp"

/// Programs and libraries of different versions: structs that are smaller or larger than this version's.
extern "C" const std::size_t sizes_in_c[13];

namespace motorcade {
namespace {

using test::plainCamera;
using test::replayOptions;
using test::sized;
using testing::Each;
using testing::HasSubstr;

constexpr std::byte kUntouched{0xAB};

/// Bytes that a program gets whose struct ends after `bytes`, with those behind it.
template <class Struct, class Call>
std::vector<std::byte> filledUpTo(std::size_t bytes, const Call& call) {
  Struct filled;
  std::memset(&filled, static_cast<int>(kUntouched), sizeof filled);
  filled.struct_size = bytes;
  EXPECT_EQ(call(&filled), MOTORCADE_OK) << motorcade_last_error();
  EXPECT_EQ(filled.struct_size, bytes);
  const auto* begin = reinterpret_cast<const std::byte*>(&filled);
  return {begin + sizeof(std::size_t), begin + sizeof filled};
}

/// Expects that the first half of a struct is the same when the rest is not there, and that the rest is not written.
template <class Struct, class Call>
void expectServedUpToItsSize(const Call& call) {
  constexpr std::size_t kHalf_bytes = sizeof(Struct) / 2 / sizeof(double) * sizeof(double);
  const auto whole = filledUpTo<Struct>(sizeof(Struct), call);
  const auto half = filledUpTo<Struct>(kHalf_bytes, call);
  const auto end = half.begin() + (kHalf_bytes - sizeof(std::size_t));
  EXPECT_TRUE(std::equal(half.begin(), end, whole.begin()));
  EXPECT_THAT(std::vector<std::byte>(end, half.end()), Each(kUntouched));
  EXPECT_NE(whole, half);
}

TEST(CInterfaceGrowth, OlderProgramsGetWhatTheirStructsHold) {
  const auto options = replayOptions();
  const auto tracker = test::trackerOf(plainCamera(), &options);
  const std::vector<std::uint8_t> pixels(std::size_t{128} * 96, 100);
  auto image = sized<motorcade_image>();
  image.pixels = pixels.data();
  image.width_px = 128;
  image.height_px = 96;
  auto pair = sized<motorcade_pair>();
  motorcade_pair_init(&pair);
  pair.left = pair.right = &image;
  auto push = sized<motorcade_push>();
  ASSERT_EQ(motorcade_tracker_push(tracker.get(), &pair, &push), MOTORCADE_OK);
  const auto result = test::taken(tracker.get());

  expectServedUpToItsSize<motorcade_frame>([&](motorcade_frame* f) { return motorcade_result_frame(result.get(), f); });
  expectServedUpToItsSize<motorcade_counts>(
      [&](motorcade_counts* c) { return motorcade_tracker_counts(tracker.get(), c); });
  expectServedUpToItsSize<motorcade_options>(motorcade_options_init);
  const auto short_push = filledUpTo<motorcade_push>(offsetof(motorcade_push, why), [&](motorcade_push* p) {
    pair.stamp_ns += 100'000'000;
    return motorcade_tracker_push(tracker.get(), &pair, p);
  });
  EXPECT_EQ(short_push.back(), kUntouched);
}

TEST(CInterfaceGrowth, OlderProgramsOptionsHaveDefaultsForTheRest) {
  motorcade_options options;
  std::memset(&options, static_cast<int>(kUntouched), sizeof options);  // a log that must not be called, and so on
  options.struct_size = offsetof(motorcade_options, axes);
  options.policy = MOTORCADE_POLICY_REPLAY;
  EXPECT_NE(test::trackerOf(plainCamera(), &options), nullptr) << motorcade_last_error();
}

/// Pixels of another size than the camera's are rejected where they are read.
TEST(CInterfaceGrowth, OlderProgramsPairsHaveNoInstanceLabels) {
  const auto options = replayOptions();
  const auto tracker = test::trackerOf(plainCamera(), &options);
  const std::vector<std::uint8_t> pixels(std::size_t{128} * 96, 100);
  auto image = sized<motorcade_image>();
  image.pixels = pixels.data();
  image.width_px = 128;
  image.height_px = 96;
  auto labels = image;
  labels.width_px = 96;
  auto pair = sized<motorcade_pair>();
  pair.left = pair.right = &image;
  pair.instances = &labels;
  auto push = sized<motorcade_push>();
  ASSERT_EQ(motorcade_tracker_push(tracker.get(), &pair, &push), MOTORCADE_OK);
  EXPECT_EQ(push.status, MOTORCADE_PUSH_REJECTED);
  pair.struct_size = offsetof(motorcade_pair, instances);
  ASSERT_EQ(motorcade_tracker_push(tracker.get(), &pair, &push), MOTORCADE_OK);
  EXPECT_EQ(push.status, MOTORCADE_PUSH_ACCEPTED) << push.why;
}

TEST(CInterfaceGrowth, OlderProgramsCamerasHaveNoRig) {
  auto camera = plainCamera();
  camera.rig = reinterpret_cast<const motorcade_rig*>(1);
  camera.struct_size = offsetof(motorcade_camera, rig);
  EXPECT_NE(test::trackerOf(camera, nullptr), nullptr) << motorcade_last_error();
}

/// Options as a later version may have them.
struct LaterOptions {
  motorcade_options known;
  std::array<std::int64_t, 3> later;
};

TEST(CInterfaceGrowth, NewerProgramsAreServedWhileTheirNewMembersAreZero) {
  LaterOptions options;
  std::memset(&options, static_cast<int>(kUntouched), sizeof options);
  options.known.struct_size = sizeof options;
  ASSERT_EQ(motorcade_options_init(&options.known), MOTORCADE_OK);
  EXPECT_THAT(options.later, Each(0));
  EXPECT_EQ(options.known.threads, 2);
  EXPECT_NE(test::trackerOf(plainCamera(), &options.known), nullptr) << motorcade_last_error();

  options.later.back() = 1;
  EXPECT_EQ(test::trackerOf(plainCamera(), &options.known), nullptr);
  EXPECT_STREQ(motorcade_last_error_field(), "options.struct_size");
  EXPECT_THAT(motorcade_last_error(), HasSubstr("newer"));
}

/// Layouts compiled into programs must not move: members are appended (docs: the header's rule). 64-bit Linux.
TEST(CInterfaceGrowth, TheFirstVersionsLayoutStays) {
  const std::array<std::size_t, 13> last{112, 120, 136, 40, 48, 88, 24, 48, 1088, 808, 40, 4, 1};
  constexpr std::size_t kCameraAtFirst = 88, kPairAtFirst = 40, kOptionsAtFirst = 80, kFrameAtFirst = 792,
                        kObjectAtFirst = 752;
  EXPECT_EQ(offsetof(motorcade_camera, has_sigmas), kCameraAtFirst);
  EXPECT_EQ(offsetof(motorcade_pair, instances), kPairAtFirst);
  EXPECT_EQ(offsetof(motorcade_options, covariance_frames), kOptionsAtFirst);
  EXPECT_EQ(offsetof(motorcade_frame, has_pose_covariance), kFrameAtFirst);
  EXPECT_EQ(offsetof(motorcade_object, acceleration_mps2), kObjectAtFirst);
  const std::array<std::size_t, 13> now{sizeof(motorcade_lens),
                                        sizeof(motorcade_rig),
                                        sizeof(motorcade_camera),
                                        sizeof(motorcade_image),
                                        sizeof(motorcade_pair),
                                        sizeof(motorcade_options),
                                        sizeof(motorcade_push),
                                        sizeof(motorcade_counts),
                                        sizeof(motorcade_frame),
                                        sizeof(motorcade_object),
                                        sizeof(motorcade_mask),
                                        sizeof(motorcade_code),
                                        sizeof(bool)};
  EXPECT_EQ(now, last);
  EXPECT_THAT(sizes_in_c, testing::ElementsAreArray(now));
}

/// No struct ends with bytes that no member has, as a later member would then not change the size.
TEST(CInterfaceGrowth, StructsEndWithTheirLastMember) {
  EXPECT_EQ(offsetof(motorcade_lens, coefficients) + sizeof(double[8]), sizeof(motorcade_lens));
  EXPECT_EQ(offsetof(motorcade_rig, T_right_left) + sizeof(double[12]), sizeof(motorcade_rig));
  EXPECT_EQ(offsetof(motorcade_camera, sigma_disparity_px) + sizeof(double), sizeof(motorcade_camera));
  EXPECT_EQ(offsetof(motorcade_image, stride_bytes) + sizeof(std::int64_t), sizeof(motorcade_image));
  EXPECT_EQ(offsetof(motorcade_pair, instances) + sizeof(motorcade_image*), sizeof(motorcade_pair));
  EXPECT_EQ(offsetof(motorcade_options, covariance_frames) + sizeof(std::int64_t), sizeof(motorcade_options));
  EXPECT_EQ(offsetof(motorcade_push, why) + sizeof(char*), sizeof(motorcade_push));
  EXPECT_EQ(offsetof(motorcade_counts, untaken) + sizeof(std::int64_t), sizeof(motorcade_counts));
  EXPECT_EQ(offsetof(motorcade_frame, pose_covariance) + sizeof(double[36]), sizeof(motorcade_frame));
  EXPECT_EQ(offsetof(motorcade_object, box_center_sigma_m) + sizeof(double[3]), sizeof(motorcade_object));
  EXPECT_EQ(offsetof(motorcade_mask, inside) + sizeof(void*), sizeof(motorcade_mask));
  EXPECT_EQ(offsetof(motorcade_vehicle_motion, yaw_rate_sigma_radps) + sizeof(double),
            sizeof(motorcade_vehicle_motion));
}

}  // namespace
}  // namespace motorcade
