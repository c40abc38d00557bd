#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_fields.hpp"
#include "apps/bridge/messages/topics.hpp"
#include "motorcade/motorcade.hpp"
#include "tests/apps/bridge/bridge_process.hpp"
#include "tests/support/matchers.hpp"

/// The messages of `motorcade bridge` for planners: objects with velocities and covariances, the state of the tracker,
/// and the vehicle's frame.
namespace motorcade::test {
namespace {

/// The results of a drive from the first stamp on, whose camera sits at `T_child_cam`.
struct SentDrive {
  std::vector<Result> results;
  SE3 T_child_cam;

  SE3 T_world_child(const Result& result) const {
    return T_child_cam * transformOf(result.T_world_cam) * T_child_cam.inverse();
  }
  std::string uuid(const Result::Object& object) const { return textOf(uuidOf(object.id, results.front().stamp_ns)); }
};

Eigen::Vector3d fromTriple(const std::array<double, 3>& values) { return Eigen::Vector3d(values.data()); }

std::string uuidIn(const json& bytes) {
  ros::Uuid uuid{};
  for (std::size_t i = 0; i < uuid.size(); ++i) uuid[i] = bytes[i];
  return textOf(uuid);
}

SE3 boxIn(const SE3& T_parent_body, const Result::Object& object) {
  return T_parent_body * SE3(Eigen::Matrix3d::Identity(), fromTriple(object.box_center_body_m));
}

/// Pose of the cuboid in the world, and its velocity along its own axes: neither depends on where the camera sits.
void expectTracked(const json& sent, const Result::Object& object, const SentDrive& drive) {
  EXPECT_EQ(uuidIn(sent["id"]), drive.uuid(object));
  const SE3 T_world_body = drive.T_child_cam * transformOf(object.T_world_body);
  expectPose(sent["pose"], boxIn(T_world_body, object));
  const Eigen::Vector3d velocity_body =
      transformOf(object.T_world_body).rotation().transpose() * fromTriple(object.velocity_world_mps) +
      Eigen::Vector3d(0, 0, object.yaw_rate_radps).cross(fromTriple(object.box_center_body_m));
  expectNumbers(sent["linear"], std::array{velocity_body.x(), velocity_body.y(), velocity_body.z()});
  expectNumbers(sent["angular"], std::array{0.0, 0.0, object.yaw_rate_radps});
  expectNumbers(sent["dimensions"], object.box_size_m);
  EXPECT_FLOAT_EQ(sent["existence_probability"], static_cast<float>(object.existence_probability));
  EXPECT_EQ(sent["is_stationary"], object.state == Result::State::kStopped);
  EXPECT_EQ(sent["orientation_availability"], 2) << "a car that drives heads somewhere";
  EXPECT_LT(sent["pose_covariance"][0], 100) << "known";
  EXPECT_GT(sent["twist_covariance"][0], 0);
  if (!object.acceleration) return;
  EXPECT_NEAR(sent["linear_acceleration"][0], object.acceleration->along_mps2, kProgramRounding);
}

void expectDetections(const json& sent, const Result& result, const SentDrive& drive) {
  std::size_t next = 0;
  for (const Result::Object& object : result.objects) {
    if (object.state == Result::State::kPredicted) continue;
    ASSERT_LT(next, sent["detections"].size());
    const json& detection = sent["detections"][next++];
    EXPECT_EQ(detection["id"], drive.uuid(object));
    expectPose(detection["center"], boxIn(drive.T_child_cam * transformOf(object.T_cam_body), object));
    expectNumbers(detection["size"], object.box_size_m);
    double sum = 0;
    for (const json& hypothesis : detection["results"]) sum += hypothesis["score"].get<double>();
    EXPECT_NEAR(sum, object.existence_probability, kProgramRounding);
  }
  EXPECT_EQ(next, sent["detections"].size());
}

void expectStatus(const json& sent, const Result& result) {
  ASSERT_EQ(sent["status"].size(), 1U);
  const json& status = sent["status"][0];
  EXPECT_EQ(status["level"], result.cause == Result::Cause::kNone ? 0 : 1);
  EXPECT_EQ(status["hardware_id"], fs::path(kDrive).filename().string());
  EXPECT_EQ(status["values"]["frame"], std::to_string(result.frame));
  EXPECT_EQ(status["values"]["objects"], std::to_string(result.objects.size()));
}

/// All that came on some topics; each has a message per frame.
struct Received {
  Received(const std::string& lines, std::size_t frames) {
    for (std::size_t i = 0; i < kTopicCount; ++i)
      messages[i] = messagesOf(lines, std::string("rt/") + kTopicNames[i].ros);
    for (const auto& topic : messages) EXPECT_TRUE(topic.empty() || topic.size() == frames) << topic.size();
  }
  const std::vector<json>& of(Topic topic) const { return messages[static_cast<std::size_t>(topic)]; }
  std::array<std::vector<json>, kTopicCount> messages;
};

TEST_F(Bridge, TellsOfObjectsAsAutowareAndVisionMsgsKnowThem) {
  Process subscriber = this->subscriber();
  Process bridge = this->bridge(
      {"--rate", "10", "--wait-for-subscribers", "1", "--topics", "tracked_objects,detections,diagnostics,tf"});
  ASSERT_EQ(bridge.end(60s), 0) << bridge.said();
  ASSERT_EQ(subscriber.end(20s), 0);
  const SentDrive drive{.results = trackedHere(), .T_child_cam = SE3()};
  const Received received(subscriber.said(), drive.results.size());
  EXPECT_TRUE(received.of(Topic::kPose).empty() && received.of(Topic::kOdometry).empty()) << "not asked for";
  ASSERT_EQ(received.of(Topic::kTrackedObjects).size(), drive.results.size()) << bridge.said();
  ASSERT_EQ(received.of(Topic::kDetections).size(), drive.results.size());
  ASSERT_EQ(received.of(Topic::kDiagnostics).size(), drive.results.size());
  ASSERT_EQ(received.of(Topic::kTf).size(), drive.results.size());
  std::size_t seen = 0;
  for (std::size_t i = 0; i < drive.results.size(); ++i) {
    SCOPED_TRACE(i);
    const Result& result = drive.results[i];
    const json &tracked = received.of(Topic::kTrackedObjects)[i],
               &transform = received.of(Topic::kTf)[i]["transforms"][0];
    expectStamped(tracked["header"], result, "odom");
    ASSERT_EQ(tracked["objects"].size(), result.objects.size());
    for (std::size_t k = 0; k < result.objects.size(); ++k)
      expectTracked(tracked["objects"][k], result.objects[k], drive);
    expectStamped(received.of(Topic::kDetections)[i]["header"], result, "camera");
    expectDetections(received.of(Topic::kDetections)[i], result, drive);
    expectStatus(received.of(Topic::kDiagnostics)[i], result);
    expectStamped(transform["header"], result, "odom");
    EXPECT_EQ(transform["child_frame_id"], "camera");
    expectPose(transform["pose"], transformOf(result.T_world_cam));
    seen += result.objects.size();
  }
  EXPECT_GT(seen, 0U) << "objects appear";
}

TEST_F(Bridge, TellsOfTheVehicleWhereTheMountingIsTold) {
  Process subscriber = this->subscriber();
  Process bridge = this->bridge({"--rate", "10", "--wait-for-subscribers", "1", "--mounting", "-1.6,0.4,1.5,0,10,90",
                                 "--topics", "pose,odometry,tracked_objects,detections"});
  ASSERT_EQ(bridge.end(60s), 0) << bridge.said();
  ASSERT_EQ(subscriber.end(20s), 0);
  const double pitch_rad = std::numbers::pi / 18;
  const SE3 T_base_cam(expSO3({0, 0, std::numbers::pi / 2}) * expSO3({0, pitch_rad, 0}), {-1.6, 0.4, 1.5});
  const SentDrive drive{.results = trackedHere(), .T_child_cam = T_base_cam};
  const Received received(subscriber.said(), drive.results.size());
  ASSERT_EQ(received.of(Topic::kOdometry).size(), drive.results.size()) << bridge.said();
  for (std::size_t i = 0; i < drive.results.size(); ++i) {
    SCOPED_TRACE(i);
    const Result& result = drive.results[i];
    const json &odometry = received.of(Topic::kOdometry)[i], &tracked = received.of(Topic::kTrackedObjects)[i];
    expectPose(received.of(Topic::kPose)[i]["pose"], drive.T_world_child(result));
    expectPose(odometry["pose"], drive.T_world_child(result));
    EXPECT_EQ(odometry["child_frame_id"], "base_link");
    const Vector6d twist = T_base_cam.adjoint() * Eigen::Map<const Vector6d>(result.velocity.data());
    expectNumbers(odometry["linear"], std::array{twist[0], twist[1], twist[2]});
    expectNumbers(odometry["angular"], std::array{twist[3], twist[4], twist[5]});
    for (std::size_t k = 0; k < result.objects.size(); ++k)
      expectTracked(tracked["objects"][k], result.objects[k], drive);
    expectStamped(received.of(Topic::kDetections)[i]["header"], result, "base_link");
    expectDetections(received.of(Topic::kDetections)[i], result, drive);
  }
}

TEST_F(Bridge, GivesObjectsOfAnotherPassOtherIds) {
  Process subscriber = this->subscriber();
  Process bridge =
      this->bridge({"--rate", "40", "--loop", "--wait-for-subscribers", "1", "--topics", "tracked_objects"});
  constexpr std::size_t kTwoPasses = 2 * MOTORCADE_RENDERED_FRAMES;
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (std::ranges::count(subscriber.said(), '\n') <= static_cast<std::ptrdiff_t>(kTwoPasses) &&
         std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(20ms);
  bridge.tell(SIGTERM);
  EXPECT_EQ(bridge.end(20s), 128 + SIGTERM) << bridge.said();
  ASSERT_EQ(subscriber.end(20s), 0);
  const auto messages = messagesOf(subscriber.said(), "rt/motorcade/tracked_objects");
  ASSERT_GT(messages.size(), kTwoPasses);
  std::set<std::string> first, second;
  for (std::size_t i = 0; i < kTwoPasses; ++i)
    for (const json& object : messages[i]["objects"])
      (i < kTwoPasses / 2 ? first : second).insert(uuidIn(object["id"]));
  EXPECT_FALSE(first.empty());
  EXPECT_EQ(first.size(), second.size());
  for (const std::string& id : first) EXPECT_FALSE(second.contains(id)) << id;
}

}  // namespace
}  // namespace motorcade::test
