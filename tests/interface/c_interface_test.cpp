#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motorcade/motorcade.h"
#include "motorcade/motorcade.hpp"
#include "tests/interface/c_handles.hpp"

/// Misuse of the C interface: a code with a field and a text, or a rejected pair; never a crash.
namespace motorcade {
namespace {

using test::Owned;
using test::plainCamera;
using test::replayOptions;
using test::sized;
using testing::HasSubstr;
using testing::StartsWith;

/// The code with the field that was complained of, as "-1 camera.baseline_m".
std::string told(motorcade_code code) {
  if (code >= 0) return std::to_string(code);
  EXPECT_THAT(motorcade_last_error(), StartsWith(std::string(motorcade_last_error_field()) + ": "));
  return std::to_string(code) + " " + motorcade_last_error_field();
}

std::string toldOf(const motorcade_camera& camera, const motorcade_options& options = replayOptions()) {
  motorcade_tracker* tracker = nullptr;
  const motorcade_code code = motorcade_tracker_create(&camera, &options, &tracker);
  EXPECT_EQ(tracker == nullptr, code != MOTORCADE_OK);
  motorcade_tracker_destroy(tracker);
  return told(code);
}

std::string toldOf(const motorcade_options& options) { return toldOf(plainCamera(), options); }

/// A tracker of the plain camera, with a pair that it accepts.
class CInterface : public testing::Test {
 protected:
  CInterface() : options_(replayOptions()), tracker_(test::trackerOf(plainCamera(), &options_)) {
    left_.pixels = pixels_.data();
    left_.width_px = 128;
    left_.height_px = 96;
    right_ = left_;
    motorcade_pair_init(&pair_);
    pair_.left = &left_;
    pair_.right = &right_;
    pair_.stamp_ns = 1'000'000'000;
  }

  /// Reason why the pair is rejected, or what the call complains of; empty when it is accepted.
  std::string pushed() {
    auto push = sized<motorcade_push>();
    const motorcade_code code = motorcade_tracker_push(tracker_.get(), &pair_, &push);
    if (code != MOTORCADE_OK) return told(code);
    EXPECT_EQ(push.status == MOTORCADE_PUSH_REJECTED, *push.why != '\0');
    return push.why;
  }

  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(std::size_t{128} * 96 * 3, 100);
  motorcade_options options_;
  motorcade_image left_ = sized<motorcade_image>(), right_{};
  motorcade_pair pair_ = sized<motorcade_pair>();
  Owned<motorcade_tracker> tracker_;
};

TEST_F(CInterface, NullHandlesAreNamed) {
  motorcade_result* result = nullptr;
  bool done = false;
  auto push = sized<motorcade_push>();
  auto counts = sized<motorcade_counts>();
  auto frame = sized<motorcade_frame>();
  auto object = sized<motorcade_object>();
  auto mask = sized<motorcade_mask>();
  auto camera = sized<motorcade_camera>();
  std::int64_t size = 0;
  EXPECT_EQ(told(motorcade_tracker_push(nullptr, &pair_, &push)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_close(nullptr)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_poll(nullptr, &result)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_wait(nullptr, 0, &result)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_done(nullptr, &done)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_on_result(nullptr, nullptr, nullptr)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_counts(nullptr, &counts)), "-2 tracker");
  EXPECT_EQ(told(motorcade_result_frame(nullptr, &frame)), "-2 result");
  EXPECT_EQ(told(motorcade_result_object(nullptr, 0, &object)), "-2 result");
  EXPECT_EQ(told(motorcade_result_mask(nullptr, 0, &mask)), "-2 result");
  EXPECT_EQ(told(motorcade_recording_camera(nullptr, &camera)), "-2 recording");
  EXPECT_EQ(told(motorcade_recording_size(nullptr, &size)), "-2 recording");
  EXPECT_EQ(told(motorcade_recording_read(nullptr, 0, &pair_)), "-2 recording");
}

TEST_F(CInterface, NullPlacesForWhatIsAskedAreNamed) {
  const motorcade_camera camera = plainCamera();
  motorcade_tracker* tracker = nullptr;
  motorcade_recording* recording = nullptr;
  EXPECT_EQ(told(motorcade_pair_init(nullptr)), "-2 pair");
  EXPECT_EQ(told(motorcade_options_init(nullptr)), "-2 options");
  EXPECT_EQ(told(motorcade_tracker_create(nullptr, nullptr, &tracker)), "-2 camera");
  EXPECT_EQ(told(motorcade_tracker_create(&camera, nullptr, nullptr)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_push(tracker_.get(), &pair_, nullptr)), "-2 push");
  EXPECT_EQ(told(motorcade_tracker_poll(tracker_.get(), nullptr)), "-2 result");
  EXPECT_EQ(told(motorcade_tracker_wait(tracker_.get(), 0, nullptr)), "-2 result");
  EXPECT_EQ(told(motorcade_tracker_done(tracker_.get(), nullptr)), "-2 done");
  EXPECT_EQ(told(motorcade_tracker_counts(tracker_.get(), nullptr)), "-2 counts");
  EXPECT_EQ(told(motorcade_recording_open("", nullptr)), "-2 recording");
  EXPECT_EQ(told(motorcade_recording_open(nullptr, &recording)), "-2 folder");
  auto push = sized<motorcade_push>();
  EXPECT_EQ(told(motorcade_tracker_push(tracker_.get(), nullptr, &push)), "-2 pair");
}

TEST_F(CInterface, TheVehiclesMotionIsTakenOrRefusedWithAReason) {
  auto motion = sized<motorcade_vehicle_motion>();
  auto push = sized<motorcade_push>();
  motion.stamp_ns = 5;
  motion.speed_mps = 12;
  EXPECT_EQ(motorcade_tracker_push_motion(tracker_.get(), &motion, &push), MOTORCADE_OK);
  EXPECT_EQ(push.status, MOTORCADE_PUSH_ACCEPTED);
  motion.speed_sigma_mps = -1;
  EXPECT_EQ(motorcade_tracker_push_motion(tracker_.get(), &motion, &push), MOTORCADE_OK);
  EXPECT_EQ(push.status, MOTORCADE_PUSH_REJECTED);
  EXPECT_THAT(push.why, HasSubstr("standard deviation"));
  motion.struct_size = offsetof(motorcade_vehicle_motion, speed_sigma_mps);  // as a first version might have been
  EXPECT_EQ(motorcade_tracker_push_motion(tracker_.get(), &motion, &push), MOTORCADE_OK);
  EXPECT_EQ(push.status, MOTORCADE_PUSH_ACCEPTED);
  motion.struct_size = 0;
  EXPECT_EQ(told(motorcade_tracker_push_motion(tracker_.get(), &motion, &push)), "-3 motion.struct_size");
  EXPECT_EQ(told(motorcade_tracker_push_motion(tracker_.get(), nullptr, &push)), "-2 motion");
  EXPECT_EQ(told(motorcade_tracker_push_motion(nullptr, &motion, &push)), "-2 tracker");
  EXPECT_EQ(told(motorcade_tracker_push_motion(tracker_.get(), &motion, nullptr)), "-2 push");
}

TEST(CInterfaceHandles, EndingNullDoesNothing) {
  motorcade_tracker_destroy(nullptr);
  motorcade_recording_close(nullptr);
  motorcade_result_release(nullptr);
}

TEST_F(CInterface, StructsWithoutTheirSizeAreNamed) {
  motorcade_tracker* tracker = nullptr;
  motorcade_camera camera = plainCamera();
  motorcade_options options{};
  motorcade_push push{};
  motorcade_counts counts{};
  EXPECT_EQ(told(motorcade_options_init(&options)), "-3 options.struct_size");
  EXPECT_EQ(told(motorcade_tracker_create(&camera, &options, &tracker)), "-3 options.struct_size");
  for (const std::size_t size : {std::size_t{0}, offsetof(motorcade_camera, baseline_m), std::size_t{1} << 40}) {
    camera.struct_size = size;
    EXPECT_EQ(told(motorcade_tracker_create(&camera, nullptr, &tracker)), "-3 camera.struct_size");
  }
  EXPECT_EQ(told(motorcade_tracker_push(tracker_.get(), &pair_, &push)), "-3 push.struct_size");
  EXPECT_EQ(told(motorcade_tracker_counts(tracker_.get(), &counts)), "-3 counts.struct_size");
  right_.struct_size = 0;
  EXPECT_EQ(pushed(), "-3 pair.right.struct_size");
  pair_.struct_size = sizeof(std::size_t);
  EXPECT_EQ(pushed(), "-3 pair.struct_size");
  EXPECT_EQ(told(motorcade_pair_init(&pair_)), "-3 pair.struct_size");
}

TEST(CInterfaceCamera, BadMembersAreNamed) {
  auto camera = plainCamera();
  camera.baseline_m = -1;
  EXPECT_EQ(toldOf(camera), "-1 camera.baseline_m");
  EXPECT_THAT(motorcade_last_error(), HasSubstr("meters"));
  camera = plainCamera();
  camera.width_px = 3;
  EXPECT_EQ(toldOf(camera), "-1 camera.width_px");
  camera = plainCamera();
  camera.ignored_bottom_px = camera.height_px;
  EXPECT_EQ(toldOf(camera), "-1 camera.ignored.bottom_px");
}

TEST(CInterfaceCamera, AMaskIsReadAsLargeAsTheImage) {
  auto camera = plainCamera();
  const std::vector<std::uint8_t> mask(static_cast<std::size_t>(camera.width_px) * camera.height_px, 1);
  camera.ignored_mask = mask.data();
  EXPECT_EQ(toldOf(camera), "0");
  camera.height_px = 1'000'000'000;
  EXPECT_EQ(toldOf(camera), "-1 camera.height_px");
}

TEST(CInterfaceCamera, BadRigsAreNamed) {
  auto left = sized<motorcade_lens>();
  left.fx_px = left.fy_px = 100;
  left.cx_px = 64;
  left.cy_px = 48;
  motorcade_lens right = left;
  auto rig = sized<motorcade_rig>();
  rig.left = &left;
  auto camera = plainCamera();
  camera.rig = &rig;
  EXPECT_EQ(toldOf(camera), "-2 camera.rig.right");
  rig.right = &right;
  EXPECT_EQ(toldOf(camera), "-1 camera.rig.T_right_left");
  right.fy_px = 0;
  EXPECT_EQ(toldOf(camera), "-1 camera.rig.right.fy_px");
  left.distortion = static_cast<motorcade_distortion>(3);
  EXPECT_EQ(toldOf(camera), "-1 camera.rig.left.distortion");
  left.struct_size = 0;
  EXPECT_EQ(toldOf(camera), "-3 camera.rig.left.struct_size");
  rig.struct_size = 0;
  EXPECT_EQ(toldOf(camera), "-3 camera.rig.struct_size");
}

TEST(CInterfaceOptions, BadMembersAreNamed) {
  const auto toldWith = [](const std::function<void(motorcade_options&)>& change) {
    auto options = replayOptions();
    change(options);
    return toldOf(options);
  };
  static constexpr int kNoCpu = -1;
  EXPECT_EQ(toldWith([](auto& o) { o.policy = static_cast<motorcade_policy>(2); }), "-1 options.policy");
  EXPECT_EQ(toldWith([](auto& o) { o.axes = static_cast<motorcade_axes>(-1); }), "-1 options.axes");
  EXPECT_EQ(toldWith([](auto& o) { o.threads = 0; }), "-1 options.threads");
  EXPECT_EQ(toldWith([](auto& o) { o.realtime_priority = 100; }), "-1 options.realtime_priority");
  EXPECT_EQ(toldWith([](auto& o) { o.cpu_count = 1; }), "-2 options.cpus");
  EXPECT_EQ(toldWith([](auto& o) { o.cpu_count = SIZE_MAX, o.cpus = &kNoCpu; }), "-1 options.cpu_count");
  EXPECT_EQ(toldWith([](auto& o) { o.cpu_count = 1, o.cpus = &kNoCpu; }), "-1 options.cpus");
  EXPECT_EQ(toldWith([](auto& o) { o.covariance_frames = 0; }), "-1 options.covariance_frames");
  EXPECT_EQ(toldWith([](auto& o) { o.patience_ms = -1; }), "-1 options.patience_ms");
  EXPECT_EQ(toldWith([](auto& o) { o.settings = "frontend.no_such_key = 1"; }), "-1 options.settings");
  EXPECT_THAT(motorcade_last_error(), HasSubstr("no_such_key"));
}

TEST_F(CInterface, PairsThatCannotBeAreRejectedWithTheReason) {
  EXPECT_EQ(pushed(), "");
  EXPECT_THAT(pushed(), HasSubstr("stamp"));  // the same once more
  pair_.stamp_ns += 100'000'000;
  pair_.right = nullptr;
  EXPECT_THAT(pushed(), HasSubstr("no pixels"));
  pair_.right = &right_;
  right_.pixels = nullptr;
  EXPECT_THAT(pushed(), HasSubstr("no pixels"));
  right_ = left_;
  left_.width_px = 96;
  EXPECT_THAT(pushed(), HasSubstr("size"));
  left_ = right_;
  left_.stride_bytes = 1;
  EXPECT_THAT(pushed(), HasSubstr("stride"));
  left_ = right_;
  left_.format = static_cast<motorcade_format>(4);
  EXPECT_EQ(pushed(), "-1 pair.left.format");
  left_ = right_;
  EXPECT_EQ(motorcade_tracker_close(tracker_.get()), MOTORCADE_OK);
  EXPECT_THAT(pushed(), HasSubstr("closed"));

  auto counts = sized<motorcade_counts>();
  EXPECT_EQ(motorcade_tracker_counts(tracker_.get(), &counts), MOTORCADE_OK);
  EXPECT_EQ(counts.pushed, 7);  // without the one whose format is none
  EXPECT_EQ(counts.rejected, 6);
}

TEST_F(CInterface, InstanceLabelsAreTakenOrRefusedWithAReason) {
  motorcade_image labels = left_;
  pair_.instances = &labels;
  EXPECT_EQ(pushed(), "");
  pair_.stamp_ns += 100'000'000;
  labels.format = MOTORCADE_GRAY16;
  EXPECT_EQ(pushed(), "");
  pair_.stamp_ns += 100'000'000;
  labels.pixels = nullptr;
  EXPECT_EQ(pushed(), "");
  pair_.stamp_ns += 100'000'000;
  labels = left_;
  labels.height_px = 95;
  EXPECT_EQ(pushed(), "the instance labels are not of the camera's size");
  labels = left_;
  labels.format = MOTORCADE_BGR8;
  EXPECT_EQ(pushed(), "the instance labels are not gray of 8 or 16 bits");
  labels.format = static_cast<motorcade_format>(4);
  EXPECT_EQ(pushed(), "-1 pair.instances.format");
  labels.struct_size = 0;
  EXPECT_EQ(pushed(), "-3 pair.instances.struct_size");
}

TEST_F(CInterface, WaitingTellsNothingYetFromNothingMore) {
  auto* result = reinterpret_cast<motorcade_result*>(this);
  bool done = true;
  EXPECT_EQ(motorcade_tracker_poll(tracker_.get(), &result), MOTORCADE_NONE);
  EXPECT_EQ(result, nullptr);
  EXPECT_EQ(motorcade_tracker_wait(tracker_.get(), 1, &result), MOTORCADE_NONE);
  EXPECT_EQ(motorcade_tracker_done(tracker_.get(), &done), MOTORCADE_OK);
  EXPECT_FALSE(done);
  EXPECT_EQ(pushed(), "");
  motorcade_tracker_close(tracker_.get());
  EXPECT_NE(test::taken(tracker_.get()), nullptr);
  EXPECT_EQ(motorcade_tracker_wait(tracker_.get(), INT64_MAX, &result), MOTORCADE_DONE);
  EXPECT_EQ(motorcade_tracker_poll(tracker_.get(), &result), MOTORCADE_DONE);
  EXPECT_EQ(motorcade_tracker_done(tracker_.get(), &done), MOTORCADE_OK);
  EXPECT_TRUE(done);
}

TEST_F(CInterface, PairsWithoutANumberCountOn) {
  EXPECT_EQ(pushed(), "");
  pair_.stamp_ns += 100'000'000;
  EXPECT_EQ(pushed(), "");
  for (const std::int64_t number : {0, 1}) {
    auto frame = sized<motorcade_frame>();
    EXPECT_EQ(motorcade_result_frame(test::taken(tracker_.get()).get(), &frame), MOTORCADE_OK);
    EXPECT_EQ(frame.frame, number);
  }
}

TEST_F(CInterface, ErrorsAreOfTheirThread) {
  EXPECT_EQ(told(motorcade_tracker_close(nullptr)), "-2 tracker");
  std::jthread([] {
    EXPECT_STREQ(motorcade_last_error(), "");
    EXPECT_STREQ(motorcade_last_error_field(), "");
    EXPECT_EQ(told(motorcade_options_init(nullptr)), "-2 options");
  }).join();
  EXPECT_EQ(motorcade_tracker_close(tracker_.get()), MOTORCADE_OK);  // nor does a good call change them
  EXPECT_STREQ(motorcade_last_error_field(), "tracker");
}

TEST(CInterfaceRecording, WhatIsNotThereIsNamed) {
  auto* recording = reinterpret_cast<motorcade_recording*>(1);
  EXPECT_EQ(told(motorcade_recording_open("/no/such/drive", &recording)), "-1 folder");
  EXPECT_EQ(recording, nullptr);
  EXPECT_THAT(motorcade_last_error(), HasSubstr("/no/such/drive"));
}

TEST(CInterfaceVersion, IsThatOfTheLibrary) { EXPECT_STREQ(motorcade_version(), version()); }

}  // namespace
}  // namespace motorcade
