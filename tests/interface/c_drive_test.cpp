#include "tests/interface/c_drive.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motorcade/motorcade.h"
#include "motorcade/motorcade.hpp"
#include "tests/interface/c_handles.hpp"

/// A rendered drive in C and in C++: the same results, bit for bit.
namespace motorcade {
namespace {

using test::cameraOf;
using test::CResults;
using test::kDrive;
using test::openDrive;
using test::Owned;
using test::replayOptions;
using test::sized;

constexpr int kFrames = 14;  // as it is rendered (tests/apps/CMakeLists.txt)

/// Pushes the whole drive, each pair as `change` makes it.
template <class Change>
void play(motorcade_recording* drive, motorcade_tracker* tracker, const Change& change) {
  auto pair = sized<motorcade_pair>();
  auto push = sized<motorcade_push>();
  for (std::int64_t i = 0; motorcade_recording_read(drive, i, &pair) == MOTORCADE_OK; ++i) {
    change(pair);
    EXPECT_EQ(motorcade_tracker_push(tracker, &pair, &push), MOTORCADE_OK) << motorcade_last_error();
    EXPECT_EQ(push.status, MOTORCADE_PUSH_ACCEPTED) << push.why;
  }
  EXPECT_EQ(motorcade_tracker_close(tracker), MOTORCADE_OK);
}

void asItIs(const motorcade_pair&) {}

template <class Change = void (*)(const motorcade_pair&)>
CResults followedInC(const motorcade_camera& camera, const motorcade_options& options, const Change& change = asItIs) {
  const auto drive = openDrive();
  const auto tracker = test::trackerOf(camera, &options);
  EXPECT_NE(tracker, nullptr) << motorcade_last_error();
  play(drive.get(), tracker.get(), change);
  CResults results;
  while (auto result = test::taken(tracker.get())) results.push_back(std::move(result));
  return results;
}

std::vector<Result> followed(const Camera& camera, Tracker::Options options) {
  options.policy = Tracker::Policy::kReplay;
  Recording drive(kDrive);
  Tracker tracker(camera, options);
  for (std::int64_t i = 0; i < drive.size(); ++i) tracker.push(drive.read(i));
  tracker.close();
  std::vector<Result> results;
  while (!tracker.done())
    if (auto result = tracker.wait(std::chrono::seconds(1))) results.push_back(std::move(*result));
  return results;
}

template <std::size_t kCount>
auto bitsOf(const std::array<double, kCount>& numbers) {
  return std::bit_cast<std::array<std::uint64_t, kCount>>(numbers);
}

template <std::size_t kCount>
void expectSame(const std::array<double, kCount>& expected, const double (&numbers)[kCount], const char* what) {
  EXPECT_EQ(bitsOf(expected), bitsOf(std::to_array(numbers))) << what;
}

template <class Covariance, std::size_t kCount>
void expectSame(const std::optional<Covariance>& expected, bool has, const double (&numbers)[kCount]) {
  EXPECT_EQ(expected.has_value(), has);
  if (expected) expectSame(*expected, numbers, "covariance");
}

void expectSame(const std::optional<Result::Mask>& expected, const motorcade_result* result, std::size_t index) {
  auto mask = sized<motorcade_mask>();
  EXPECT_EQ(motorcade_result_mask(result, index, &mask), expected ? MOTORCADE_OK : MOTORCADE_NONE);
  if (!expected) {
    EXPECT_EQ(mask.inside, nullptr);
    return;
  }
  EXPECT_EQ(mask.left_px, expected->left_px);
  EXPECT_EQ(mask.top_px, expected->top_px);
  EXPECT_EQ(mask.cell_px, expected->cell_px);
  EXPECT_EQ(mask.width_cells, expected->width_cells);
  EXPECT_EQ(mask.height_cells, expected->height_cells);
  EXPECT_THAT(std::span(mask.inside, static_cast<std::size_t>(mask.width_cells) * mask.height_cells),
              testing::ElementsAreArray(expected->inside));
}

void expectSame(const Result::Object& expected, const motorcade_object& object) {
  EXPECT_EQ(object.id, expected.id);
  EXPECT_EQ(int{object.state}, static_cast<int>(expected.state));
  EXPECT_EQ(object.points, expected.points);
  expectSame(expected.T_world_body, object.T_world_body, "T_world_body");
  expectSame(expected.T_cam_body, object.T_cam_body, "T_cam_body");
  expectSame(expected.covariance, object.has_covariance, object.covariance);
  expectSame(expected.velocity_world_mps, object.velocity_world_mps, "velocity");
  expectSame(expected.velocity_covariance, object.velocity_covariance, "velocity covariance");
  EXPECT_EQ(object.yaw_rate_radps, expected.yaw_rate_radps);
  EXPECT_EQ(object.yaw_rate_sigma_radps, expected.yaw_rate_sigma_radps);
  EXPECT_EQ(object.age_s, expected.age_s);
  expectSame(expected.image_box_px, object.image_box_px, "image box");
  expectSame(expected.box_center_body_m, object.box_center_body_m, "box center");
  expectSame(expected.box_size_m, object.box_size_m, "box size");
  expectSame(expected.box_size_sigma_m, object.box_size_sigma_m, "box size sigma");
  expectSame(expected.box_center_sigma_m, object.box_center_sigma_m, "box center sigma");
  EXPECT_EQ(int{object.kind}, static_cast<int>(expected.kind));
  EXPECT_EQ(object.kind_probability, expected.kind_probability);
  EXPECT_EQ(object.existence_probability, expected.existence_probability);
  EXPECT_EQ(std::isnan(object.acceleration_mps2), !expected.acceleration);
  EXPECT_EQ(std::isnan(object.yaw_acceleration_sigma_radps2), !expected.acceleration);
  if (!expected.acceleration) return;
  EXPECT_EQ(object.acceleration_mps2, expected.acceleration->along_mps2);
  EXPECT_EQ(object.acceleration_sigma_mps2, expected.acceleration->along_sigma_mps2);
  EXPECT_EQ(object.yaw_acceleration_radps2, expected.acceleration->yaw_radps2);
  EXPECT_EQ(object.yaw_acceleration_sigma_radps2, expected.acceleration->yaw_sigma_radps2);
}

/// Compares all but the latency, which is of the clock.
void expectSame(const Result& expected, const motorcade_result* result) {
  auto frame = sized<motorcade_frame>();
  ASSERT_EQ(motorcade_result_frame(result, &frame), MOTORCADE_OK);
  EXPECT_EQ(frame.frame, expected.frame);
  EXPECT_EQ(frame.stamp_ns, expected.stamp_ns);
  EXPECT_EQ(int{frame.status}, static_cast<int>(expected.status));
  EXPECT_EQ(int{frame.cause}, static_cast<int>(expected.cause));
  EXPECT_EQ(frame.segment, expected.segment);
  EXPECT_EQ(frame.dropped_before, expected.dropped_before);
  expectSame(expected.T_world_cam, frame.T_world_cam, "T_world_cam");
  expectSame(expected.pose_covariance, frame.has_pose_covariance, frame.pose_covariance);
  expectSame(expected.motion_covariance, frame.has_motion_covariance, frame.motion_covariance);
  expectSame(expected.velocity, frame.velocity, "own velocity");
  expectSame(expected.velocity_covariance, frame.velocity_covariance, "own velocity covariance");
  EXPECT_EQ(frame.latency_ms > 0, expected.latency_ms > 0);  // finals have none
  EXPECT_EQ(frame.problem, expected.problem);
  ASSERT_EQ(frame.object_count, expected.objects.size());
  for (std::size_t i = 0; i < frame.object_count; ++i) {
    auto object = sized<motorcade_object>();
    ASSERT_EQ(motorcade_result_object(result, i, &object), MOTORCADE_OK);
    expectSame(expected.objects[i], object);
    expectSame(expected.objects[i].mask, result, i);
  }
  auto object = sized<motorcade_object>();
  EXPECT_EQ(motorcade_result_object(result, frame.object_count, &object), MOTORCADE_ERROR_VALUE);
  EXPECT_STREQ(motorcade_last_error_field(), "index");
}

void expectSame(const std::vector<Result>& expected, const CResults& results) {
  ASSERT_EQ(expected.size(), kFrames);
  ASSERT_EQ(results.size(), kFrames);
  for (std::size_t i = 0; i < kFrames; ++i) {
    SCOPED_TRACE(i);
    expectSame(expected[i], results[i].get());
  }
}

bool showsMasks(const std::vector<Result>& results) {
  for (const Result& result : results)
    for (const auto& object : result.objects)
      if (object.mask) return true;
  return false;
}

TEST(CInterfaceDrive, ItsCameraAndPairsAreThoseOfCpp) {
  const auto drive = openDrive();
  Recording expected(kDrive);
  std::int64_t size = 0;
  ASSERT_EQ(motorcade_recording_size(drive.get(), &size), MOTORCADE_OK);
  EXPECT_EQ(size, kFrames);
  EXPECT_EQ(cameraOf(drive.get()).baseline_m, expected.camera().baseline_m);
  EXPECT_TRUE(cameraOf(drive.get()).has_sigmas);
  EXPECT_EQ(cameraOf(drive.get()).sigma_focal, expected.camera().sigmas.value().focal);
  auto pair = sized<motorcade_pair>();
  ASSERT_EQ(motorcade_recording_read(drive.get(), 3, &pair), MOTORCADE_OK);
  const Pair expected_pair = expected.read(3);
  EXPECT_EQ(pair.stamp_ns, expected_pair.stamp_ns);
  EXPECT_EQ(pair.frame, 3);
  EXPECT_EQ(pair.right->stride_bytes, expected_pair.right.stride_bytes);
  EXPECT_EQ(std::memcmp(pair.right->pixels, expected_pair.right.pixels, 310), 0);  // the first row
  EXPECT_EQ(motorcade_recording_read(drive.get(), kFrames, &pair), MOTORCADE_DONE);
  EXPECT_EQ(motorcade_recording_read(drive.get(), -1, &pair), MOTORCADE_ERROR_VALUE);
  EXPECT_STREQ(motorcade_last_error_field(), "index");
}

TEST(CInterfaceDrive, GivesTheResultsOfCpp) {
  const auto expected = followed(Recording(kDrive).camera(), {});
  EXPECT_FALSE(expected.back().objects.empty());
  expectSame(expected, followedInC(cameraOf(openDrive().get()), replayOptions()));
}

TEST(CInterfaceDrive, OptionsMeanWhatTheyDoInCpp) {
  const char* const settings = "frontend.optical_flow.max_round_trip_px = 0.2";
  const int cpu = 0;
  const auto expected =
      followed(Recording(kDrive).camera(),
               {.axes = Tracker::Axes::kRep103, .masks = true, .threads = 1, .cpus = {cpu}, .settings = settings});
  auto options = replayOptions();
  options.axes = MOTORCADE_AXES_REP103;
  options.masks = true;
  options.threads = 1;
  options.cpus = &cpu;
  options.cpu_count = 1;
  options.settings = settings;
  EXPECT_TRUE(showsMasks(expected));
  expectSame(expected, followedInC(cameraOf(openDrive().get()), options));
}

TEST(CInterfaceDrive, RigsMeanWhatTheyDoInCpp) {
  Camera camera = Recording(kDrive).camera();
  const Camera::Lens lens{.fx_px = camera.fx_px,
                          .fy_px = camera.fy_px,
                          .cx_px = camera.cx_px,
                          .cy_px = camera.cy_px,
                          .distortion = Camera::Distortion::kRadialTangential,
                          .coefficients = {-0.02, 0.001}};
  camera.rig = {.left = lens, .right = lens, .T_right_left = {1, 0, 0, -camera.baseline_m, 0, 1, 0, 0, 0, 0, 1, 0}};

  motorcade_lens c_lens{sizeof(motorcade_lens),      lens.fx_px,    lens.fy_px, lens.cx_px, lens.cy_px,
                        MOTORCADE_RADIAL_TANGENTIAL, {-0.02, 0.001}};
  const motorcade_rig rig{
      sizeof(motorcade_rig), &c_lens, &c_lens, {1, 0, 0, -camera.baseline_m, 0, 1, 0, 0, 0, 0, 1, 0}};
  auto c_camera = cameraOf(openDrive().get());
  c_camera.fx_px = c_camera.baseline_m = -1;  // not read
  c_camera.rig = &rig;
  expectSame(followed(camera, {}), followedInC(c_camera, replayOptions()));
}

/// An image with each value `bytes` times over, in rows that are wider than they need to be.
class OtherImage {
 public:
  OtherImage(const motorcade_image& gray, motorcade_format format, std::int64_t bytes) : image_(gray) {
    image_.stride_bytes = gray.width_px * bytes + 7;
    image_.format = format;
    const auto* row = static_cast<const std::uint8_t*>(gray.pixels);
    for (int y = 0; y < gray.height_px; ++y, row += gray.stride_bytes) {
      for (int x = 0; x < gray.width_px; ++x) pixels_.insert(pixels_.end(), static_cast<std::size_t>(bytes), row[x]);
      pixels_.insert(pixels_.end(), 7, 0);
    }
    image_.pixels = pixels_.data();
  }
  const motorcade_image* get() const { return &image_; }

 private:
  std::vector<std::uint8_t> pixels_;
  motorcade_image image_;
};

TEST(CInterfaceDrive, FormatsAndStridesMeanWhatTheyDoInCpp) {
  std::vector<OtherImage> images;
  images.reserve(2 * kFrames);  // pairs point to them
  const auto otherwise = [&](motorcade_pair& pair) {
    pair.left = images.emplace_back(*pair.left, MOTORCADE_GRAY16, 2).get();
    pair.right = images.emplace_back(*pair.right, MOTORCADE_RGB8, 3).get();
  };
  expectSame(followed(Recording(kDrive).camera(), {}),
             followedInC(cameraOf(openDrive().get()), replayOptions(), otherwise));
}

TEST(CInterfaceDrive, ACallbackGetsTheResultsOfCpp) {
  const auto drive = openDrive();
  const auto options = replayOptions();
  test::Taken taken;
  const auto tracker = test::trackerOf(cameraOf(drive.get()), &options);
  ASSERT_EQ(motorcade_tracker_on_result(tracker.get(), test::Taken::take, &taken), MOTORCADE_OK);
  play(drive.get(), tracker.get(), asItIs);
  ASSERT_TRUE(taken.waitFor(kFrames));
  expectSame(followed(Recording(kDrive).camera(), {}), taken.results);

  auto counts = sized<motorcade_counts>();
  ASSERT_EQ(motorcade_tracker_counts(tracker.get(), &counts), MOTORCADE_OK);
  EXPECT_EQ(counts.pushed, kFrames);
  EXPECT_EQ(counts.results, kFrames);
  EXPECT_EQ(counts.rejected + counts.dropped + counts.untaken, 0);
}

TEST(CInterfaceDrive, ACallbackGetsTheFinalsOfCpp) {
  Recording recording(kDrive);
  std::vector<Result> expected;
  Tracker in_cpp(recording.camera(), {.policy = Tracker::Policy::kReplay});
  in_cpp.on_final([&](Result final) { expected.push_back(std::move(final)); });
  for (std::int64_t i = 0; i < recording.size(); ++i) in_cpp.push(recording.read(i));
  in_cpp.close();
  while (in_cpp.wait(std::chrono::hours(1))) continue;

  const auto drive = openDrive();
  const auto options = replayOptions();
  test::Taken taken;
  const auto tracker = test::trackerOf(cameraOf(drive.get()), &options);
  ASSERT_EQ(motorcade_tracker_on_final(tracker.get(), test::Taken::take, &taken), MOTORCADE_OK);
  play(drive.get(), tracker.get(), asItIs);
  ASSERT_TRUE(taken.waitFor(kFrames));
  expectSame(expected, taken.results);
  EXPECT_EQ(motorcade_tracker_on_final(tracker.get(), nullptr, nullptr), MOTORCADE_OK);
  EXPECT_EQ(motorcade_tracker_on_final(nullptr, nullptr, nullptr), MOTORCADE_ERROR_NULL);
}

TEST(CInterfaceDrive, AResetTrackerFollowsADriveFromItsFirstFrame) {
  const auto options = replayOptions();
  const auto drive = openDrive(), again = openDrive();
  const auto tracker = test::trackerOf(cameraOf(drive.get()), &options);
  play(drive.get(), tracker.get(), asItIs);
  ASSERT_EQ(motorcade_tracker_reset(tracker.get()), MOTORCADE_OK);
  play(again.get(), tracker.get(), asItIs);
  std::size_t results = 0;
  while (test::taken(tracker.get())) ++results;
  EXPECT_EQ(results, kFrames);
  EXPECT_EQ(motorcade_tracker_reset(nullptr), MOTORCADE_ERROR_NULL);
}

TEST(CInterfaceDrive, WithoutACallbackResultsAreForWaitAgain) {
  const auto drive = openDrive();
  const auto options = replayOptions();
  test::Taken taken;
  const auto tracker = test::trackerOf(cameraOf(drive.get()), &options);
  motorcade_tracker_on_result(tracker.get(), test::Taken::take, &taken);
  ASSERT_EQ(motorcade_tracker_on_result(tracker.get(), nullptr, nullptr), MOTORCADE_OK);
  play(drive.get(), tracker.get(), asItIs);
  EXPECT_NE(test::taken(tracker.get()), nullptr);
  EXPECT_TRUE(taken.results.empty());
}

}  // namespace
}  // namespace motorcade
