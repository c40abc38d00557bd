#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "motorcade/motorcade.hpp"
#include "tests/apps/bridge/bridge_process.hpp"
#include "tests/apps/bridge/bridged_cameras.hpp"

/// Tests `motorcade bridge --images`: the test publishes the cameras' images, and the results go to another process.
namespace motorcade::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr auto kMuch = 60s;  // more than a slow machine needs; nothing waits so long where all is well
constexpr StereoSide kLeft = StereoSide::kLeft, kRight = StereoSide::kRight;

bool waitFor(const std::function<bool()>& happened) {
  const auto deadline = std::chrono::steady_clock::now() + kMuch;
  while (!happened()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

class BridgedImages : public Bridge {
 protected:
  Process followed(const std::vector<std::string>& options,
                   const std::string& topics = "/left/image_raw,/right/image_raw") const {
    return bridge(options, "--images=" + topics);
  }
  /// Publishes pairs at ten a second, again and again, until it happened.
  bool publishUntil(const CameraPublishers& cameras, const std::function<bool()>& happened) {
    const Camera camera = recording_.camera();
    return waitFor([&] {
      const Pair pair = recording_.read(sent_ % recording_.size());
      const std::int64_t stamp_ns = pair_stamp_ns(sent_++);
      cameras.publishInfos(camera, stamp_ns);
      cameras.publish(kLeft, pair.left, stamp_ns);
      cameras.publish(kLeft, pair.left, stamp_ns + kPeriod_ns / 2);  // of twice the rate
      cameras.publish(kRight, pair.right, stamp_ns, /*colors=*/true);
      std::this_thread::sleep_for(80ms);
      return happened();
    });
  }
  static std::int64_t pair_stamp_ns(std::int64_t index) { return 1'000'000'000'000 + index * kPeriod_ns; }

  static constexpr std::int64_t kPeriod_ns = 100'000'000;
  Recording recording_{kDrive};
  std::int64_t sent_ = 0;
};

/// All messages about a drive except its health, which depends on time.
std::vector<json> resultsIn(const std::string& lines) {
  std::vector<json> messages;
  for (const char* const topic : {"rt/motorcade/pose", "rt/motorcade/odometry", "rt/motorcade/objects",
                                  "rt/motorcade/tracked_objects", "rt/motorcade/detections"})
    for (json& message : messagesOf(lines, topic)) messages.push_back(std::move(message));
  return messages;
}

/// The drive's image of that frame, as the bytes of its file.
std::string fileOf(StereoSide side, std::int64_t frame) {
  const std::string folder = side == kLeft ? "image_0" : "image_1";
  return contentOf(fs::path(kDrive) / folder / ("00000" + std::to_string(frame) + ".png"));
}

TEST_F(BridgedImages, EveryPairGivesTheResultsOfTheDrive) {
  std::string of_drive, of_topics;
  {
    Process subscriber = this->subscriber();
    Process drive = bridge({"--rate", "10", "--wait-for-subscribers", "1"});
    ASSERT_EQ(drive.end(kMuch), 0) << drive.said();
    ASSERT_EQ(subscriber.end(kMuch), 0);
    of_drive = subscriber.said();
  }
  Process subscriber = this->subscriber();
  Process bridge = followed({"--every-pair", "--pairs", std::to_string(recording_.size()), "--calibration",
                             std::string(kDrive) + "/calib.txt", "--wait-for-subscribers", "1"});
  {
    const CameraPublishers cameras(domain_, Driver::kReliable);
    ASSERT_TRUE(cameras.areSubscribed(kMuch, /*infos_too=*/false)) << bridge.said();
    for (std::int64_t i = 0; i < recording_.size(); ++i) {
      const Pair pair = recording_.read(i);
      cameras.publish(kLeft, pair.left, pair.stamp_ns);
      cameras.publish(kRight, pair.right, pair.stamp_ns);
    }
    ASSERT_EQ(bridge.end(kMuch), 0) << bridge.said();
  }
  ASSERT_EQ(subscriber.end(kMuch), 0);
  const auto expected = resultsIn(of_drive);
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(5 * recording_.size()));
  EXPECT_EQ(resultsIn(subscriber.said()), expected) << bridge.said();
}

TEST_F(BridgedImages, TheVehiclesMotionReachesTheTracker) {
  constexpr double kTooFast_mps = 90;
  Process subscriber = this->subscriber();
  Process bridge =
      followed({"--every-pair", "--vehicle-motion", "/vehicle/twist", "--pairs", std::to_string(recording_.size()),
                "--calibration", std::string(kDrive) + "/calib.txt", "--wait-for-subscribers", "1"});
  const CameraPublishers cameras(domain_, Driver::kReliable);
  ASSERT_TRUE(cameras.areSubscribed(kMuch, /*infos_too=*/false)) << bridge.said();
  ASSERT_TRUE(cameras.motionIsSubscribed(kMuch)) << bridge.said();
  for (std::int64_t i = 0; i < recording_.size(); ++i) cameras.publishMotion(kTooFast_mps, recording_.read(i).stamp_ns);
  for (std::int64_t i = 0; i < recording_.size(); ++i) {
    const Pair pair = recording_.read(i);
    cameras.publish(kLeft, pair.left, pair.stamp_ns);
    cameras.publish(kRight, pair.right, pair.stamp_ns);
  }
  EXPECT_EQ(bridge.end(kMuch), 0) << bridge.said();
  EXPECT_THAT(bridge.said(), HasSubstr("90 m/s and 0 rad/s are told where the camera sees"));
}

TEST_F(BridgedImages, PublishersWaitForRoomWhereEveryPairCounts) {
  constexpr std::int64_t kPairs = 150;  // many times what is kept
  Process subscriber = this->subscriber();
  Process bridge =
      followed({"--every-pair", "--pairs", std::to_string(kPairs), "--topics", "pose", "--wait-for-subscribers", "1"});
  const CameraPublishers cameras(domain_, Driver::kReliable);
  ASSERT_TRUE(cameras.areSubscribed(kMuch)) << bridge.said();
  for (std::int64_t i = 0; i < kPairs; ++i) {
    const Pair pair = recording_.read(i % recording_.size());
    if (i % 10 == 0) cameras.publishInfos(recording_.camera(), pair_stamp_ns(i));
    cameras.publish(kLeft, pair.left, pair_stamp_ns(i));
    cameras.publish(kRight, pair.right, pair_stamp_ns(i));
  }
  EXPECT_EQ(bridge.end(kMuch), 0) << bridge.said();
  EXPECT_THAT(bridge.said(), HasSubstr("150 pairs; 0 dropped by a newer one, 0 overtaken"));
  EXPECT_THAT(bridge.said(), Not(HasSubstr("had no partner")));
}

TEST_F(BridgedImages, CamerasThatSendAtOtherRatesAreFollowedByTheirCameraInfo) {
  for (const Driver driver : {Driver::kBestEffort, Driver::kReliable}) {
    Process subscriber = this->subscriber();
    Process bridge = followed({"--wait-for-subscribers", "1"});
    const CameraPublishers cameras(domain_, driver);
    ASSERT_TRUE(cameras.areSubscribed(kMuch)) << bridge.said();
    const auto poses = [&] { return messagesOf(subscriber.said(), "rt/motorcade/pose"); };
    EXPECT_TRUE(publishUntil(cameras, [&] { return poses().size() >= 5; })) << bridge.said();
    bridge.tell(SIGTERM);
    EXPECT_EQ(bridge.end(kMuch), 128 + SIGTERM) << bridge.said();
    EXPECT_EQ(subscriber.end(kMuch), 0);
    for (const json& pose : poses())
      EXPECT_EQ(pose["header"]["nanosec"].get<std::int64_t>() % kPeriod_ns, 0) << "the stamps are the images'";
    EXPECT_THAT(bridge.said(), Not(HasSubstr("rejected")));
  }
}

TEST_F(BridgedImages, ASideThatFallsSilentIsToldAndSoIsItsReturn) {
  Process subscriber = this->subscriber();
  Process bridge = followed({"--wait-for-subscribers", "1"});
  {
    const CameraPublishers cameras(domain_, Driver::kBestEffort);
    ASSERT_TRUE(cameras.areSubscribed(kMuch));
    const auto saysOfRight = [&](const std::string& text) {
      return [&, text] { return bridge.said().find(text + " on /right/image_raw") != std::string::npos; };
    };
    const auto silence = saysOfRight("no images");
    const auto diagnosed = [&] {
      for (const json& message : messagesOf(subscriber.said(), "rt/diagnostics"))
        for (const json& status : message["status"])
          if (status["name"] == "motorcade: images" && status["level"] == 2 &&
              status["message"] == "no images on /right/image_raw for 2.0 s")
            return true;
      return false;
    };
    EXPECT_TRUE(publishUntil(cameras, [&] { return !messagesOf(subscriber.said(), "rt/motorcade/pose").empty(); }));
    EXPECT_TRUE(waitFor([&] {
      const Pair pair = recording_.read(0);
      cameras.publish(kLeft, pair.left, pair_stamp_ns(sent_++));
      return silence() && diagnosed();
    })) << bridge.said();
    EXPECT_TRUE(publishUntil(cameras, saysOfRight("images come again"))) << bridge.said();
  }
  bridge.tell(SIGINT);
  EXPECT_EQ(bridge.end(kMuch), 128 + SIGINT);
}

TEST_F(BridgedImages, DriversThatStartAnewAreFollowedFurther) {
  Process subscriber = this->subscriber();
  Process bridge = followed({"--wait-for-subscribers", "1"});
  for (const std::size_t poses : {3U, 6U}) {
    const CameraPublishers cameras(domain_, Driver::kReliable);
    ASSERT_TRUE(cameras.areSubscribed(kMuch)) << bridge.said();
    sent_ = 0;  // a clock that begins anew
    EXPECT_TRUE(publishUntil(cameras, [&] {
      return messagesOf(subscriber.said(), "rt/motorcade/pose").size() >= poses && sent_ > 5;
    })) << bridge.said();
  }
  bridge.tell(SIGTERM);
  EXPECT_EQ(bridge.end(kMuch), 128 + SIGTERM);
}

TEST_F(BridgedImages, CompressedImagesAreRead) {
  Process subscriber = this->subscriber();
  Process bridge = followed({"--every-pair", "--pairs", "3", "--wait-for-subscribers", "1"},
                            "/left/image_raw/compressed,/right/image_raw/compressed");
  const CameraPublishers cameras(domain_, Driver::kReliable, /*compressed=*/true);
  ASSERT_TRUE(cameras.areSubscribed(kMuch)) << bridge.said();
  for (std::int64_t i = 0; i < 4; ++i) {
    const std::int64_t stamp_ns = pair_stamp_ns(i);
    cameras.publishInfos(recording_.camera(), stamp_ns);
    for (const StereoSide side : kStereoSides) cameras.publish(side, i == 1 ? "no image" : fileOf(side, i), stamp_ns);
  }
  EXPECT_EQ(bridge.end(kMuch), 0) << bridge.said();
  EXPECT_THAT(bridge.said(), HasSubstr("/image_raw/compressed: is neither PNG")) << "the one that is none";
  EXPECT_THAT(bridge.said(), HasSubstr("1 pairs could not be read"));
  ASSERT_EQ(subscriber.end(kMuch), 0);
  EXPECT_EQ(messagesOf(subscriber.said(), "rt/motorcade/pose").size(), 3U);
}

TEST_F(BridgedImages, WithoutCameraInfoItSaysWhatItWaitsForAndEnds) {
  Process bridge = followed({});
  EXPECT_TRUE(waitFor([&] { return bridge.said().find("give --camera or --calibration") != std::string::npos; }));
  EXPECT_THAT(bridge.said(), HasSubstr("waiting for /left/camera_info and /right/camera_info"));
  EXPECT_THAT(bridge.said(), HasSubstr("nobody publishes sensor_msgs/Image there"));
  bridge.tell(SIGINT);
  EXPECT_EQ(bridge.end(kMuch), 128 + SIGINT);
}

}  // namespace
}  // namespace motorcade::test
