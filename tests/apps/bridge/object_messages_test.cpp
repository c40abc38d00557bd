#include "apps/bridge/messages/object_messages.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_fields.hpp"
#include "tests/apps/bridge/bridged_object_by_hand.hpp"
#include "tests/apps/bridge/results_by_hand.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

/// Objects as Autoware's tracker would hand them on.
namespace motorcade::test {
namespace {

using Label = ros::ObjectClassification::Label;
using Orientation = ros::TrackedObject::Orientation;

constexpr double kDifferences = 1e-7;  // of central differences, times numbers of about one

ros::TrackedObject trackedOf(const Result::Object& object) {
  return trackedObjectsOf(bridgedResult({object}), "odom", 0).objects.at(0);
}

Eigen::Vector3d vectorIn(const ros::Vector3& v) { return {v.x, v.y, v.z}; }

SE3 poseIn(const ros::Pose& pose) {
  const auto& [x, y, z, w] = pose.orientation;
  return {Eigen::Quaterniond(w, x, y, z).toRotationMatrix(), vectorIn(pose.position)};
}

TEST(TrackedObjects, StandInTheWorldWithTheMiddleOfTheirCuboid) {
  const Result result = bridgedResult({bridgedObject()});
  const ros::TrackedObjects message = trackedObjectsOf(result, "map", 0);
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(message.header.stamp.sec, 5);
  EXPECT_EQ(message.header.stamp.nanosec, 250U);
  ASSERT_EQ(message.objects.size(), 1U);
  const SE3 T_world_box = boxOfBridged(transformOf(result.objects[0].T_world_body));
  EXPECT_THAT(poseIn(message.objects[0].pose), IsNearPose(T_world_box, kRounding));
  EXPECT_EQ(vectorIn(message.objects[0].dimensions_m), Eigen::Vector3d(5, 2, 2.2)) << "length, width, height";
  EXPECT_FLOAT_EQ(message.objects[0].existence_probability, 0.75F);
}

TEST(TrackedObjects, HaveThePoseCovarianceThatFiniteDifferencesSay) {
  const Result::Object object = bridgedObject();
  const SE3 T_world_body = transformOf(object.T_world_body);
  const auto box = [&](const SE3& moved) { return rosDifference(boxOfBridged(moved), boxOfBridged(T_world_body)); };
  const Matrix6d J = numericJacobian(box, T_world_body);
  Matrix6d expected = J * matrixOfRows(*object.covariance) * J.transpose();
  const Eigen::Matrix3d R = T_world_body.rotation();
  expected.topLeftCorner<3, 3>() += R * bridgedMiddle().asDiagonal() * R.transpose();
  EXPECT_THAT(matrixOfRows(trackedOf(object).pose_covariance), IsNear(expected, kDifferences));
}

/// The twist moves the cuboid's middle to where it is a moment later.
TEST(TrackedObjects, HaveTheTwistOfTheCuboidsMiddleAlongTheirOwnAxes) {
  const Result::Object object = bridgedObject();
  const SE3 T_world_body = transformOf(object.T_world_body);
  const auto seenAfter = [&](const Eigen::Matrix<double, 1, 1>& dt_s) {
    const SE3 moved(T_world_body.rotation() * expSO3({0, 0, object.yaw_rate_radps * dt_s[0]}),
                    T_world_body.translation() + dt_s[0] * Eigen::Vector3d(object.velocity_world_mps.data()));
    return (boxOfBridged(T_world_body).inverse() * boxOfBridged(moved)).log();
  };
  const Vector6d twist = numericJacobian(seenAfter, Eigen::Matrix<double, 1, 1>::Zero().eval());
  const ros::TrackedObject message = trackedOf(object);
  EXPECT_THAT(vectorIn(message.linear_mps), IsNear(Eigen::Vector3d(twist.head<3>()), kDifferences));
  EXPECT_THAT(vectorIn(message.angular_radps), IsNear(Eigen::Vector3d(twist.tail<3>()), kDifferences));
  EXPECT_NEAR(message.angular_radps.z, 0.4, kRounding);
}

TEST(TrackedObjects, HaveTheTwistCovarianceThatFiniteDifferencesSay) {
  const Result::Object object = bridgedObject();
  const auto twist = [&](const Eigen::Vector4d& motion) {
    Result::Object moved = object;
    for (std::size_t i = 0; i < 3; ++i) moved.velocity_world_mps[i] = motion[static_cast<Eigen::Index>(i)];
    moved.yaw_rate_radps = motion[3];
    const ros::TrackedObject message = trackedOf(moved);
    Vector6d value;
    value << vectorIn(message.linear_mps), vectorIn(message.angular_radps);
    return value;
  };
  const Eigen::Matrix<double, 6, 4> J = numericJacobian(twist, Eigen::Vector4d(3, 7, 0.2, 0.4));
  Eigen::Matrix4d motion = Eigen::Matrix4d::Zero();
  motion.topLeftCorner<3, 3>() = Eigen::Map<const Eigen::Matrix3d>(object.velocity_covariance.data());
  motion(3, 3) = 0.05 * 0.05;
  Matrix6d expected = J * motion * J.transpose();
  expected(3, 3) = expected(4, 4) = kUnknownVariance;  // how it rolls and pitches
  EXPECT_THAT(matrixOfRows(trackedOf(object).twist_covariance), IsNear(expected, kDifferences));
}

TEST(TrackedObjects, HaveAnAccelerationWhereItIsKnown) {
  const ros::TrackedObject known = trackedOf(bridgedObject());
  EXPECT_EQ(vectorIn(known.linear_mps2), Eigen::Vector3d(-1.5, 0, 0));
  EXPECT_EQ(vectorIn(known.angular_radps2), Eigen::Vector3d(0, 0, 0.3));
  Vector6d variances = Vector6d::Constant(kUnknownVariance);
  variances[0] = 0.4 * 0.4;
  variances[5] = 0.2 * 0.2;
  EXPECT_THAT(matrixOfRows(known.acceleration_covariance), IsNear(Matrix6d(variances.asDiagonal()), kRounding));
  Result::Object object = bridgedObject();
  object.acceleration.reset();
  const ros::TrackedObject unknown = trackedOf(object);
  EXPECT_EQ(vectorIn(unknown.linear_mps2), Eigen::Vector3d::Zero());
  EXPECT_EQ(matrixOfRows(unknown.acceleration_covariance), Matrix6d(kUnknownVariance * Matrix6d::Identity()));
}

TEST(TrackedObjects, AreOfAKindOrUnknownWithProbabilitiesThatSumToOne) {
  const std::vector<std::pair<Result::Kind, Label>> labels{{Result::Kind::kCar, Label::kCar},
                                                           {Result::Kind::kLargeVehicle, Label::kTruck},
                                                           {Result::Kind::kTwoWheeler, Label::kBicycle},
                                                           {Result::Kind::kPedestrian, Label::kPedestrian}};
  for (const auto& [kind, label] : labels) {
    Result::Object object = bridgedObject();
    object.kind = kind;
    const auto classification = trackedOf(object).classification;
    ASSERT_EQ(classification.size(), 2U);
    EXPECT_EQ(classification[0].label, label);
    EXPECT_FLOAT_EQ(classification[0].probability, 0.8F);
    EXPECT_EQ(classification[1].label, Label::kUnknown);
    EXPECT_FLOAT_EQ(classification[0].probability + classification[1].probability, 1);
  }
}

/// The probability is then that of a kind that is not told.
TEST(TrackedObjects, AreUnknownAloneWhereNoKindIsNamed) {
  Result::Object object = bridgedObject();
  object.kind = Result::Kind::kUnknown;
  object.kind_probability = 0.55;
  const auto classification = trackedOf(object).classification;
  ASSERT_EQ(classification.size(), 1U);
  EXPECT_EQ(classification[0].label, Label::kUnknown);
  EXPECT_EQ(classification[0].probability, 1);
}

TEST(TrackedObjects, AreStationaryWhereTheyStopped) {
  Result::Object object = bridgedObject();
  EXPECT_FALSE(trackedOf(object).is_stationary);
  object.state = Result::State::kStopped;
  EXPECT_TRUE(trackedOf(object).is_stationary);
  object.state = Result::State::kPredicted;
  EXPECT_FALSE(trackedOf(object).is_stationary) << "not seen, but still told of";
}

/// Heading is about the object's z axis, whichever way the world lies.
TEST(TrackedObjects, HaveAnOrientationUnlessTheirHeadingIsUnsureOrUnknown) {
  Result::Object object = bridgedObject();
  const auto withHeadingSigma = [&](double sigma_rad) {
    Vector6d variances = Vector6d::Constant(0.5);
    variances[5] = sigma_rad * sigma_rad;
    object.covariance = rowsByHand(Matrix6d(variances.asDiagonal()));
    return trackedOf(object).orientation;
  };
  EXPECT_EQ(withHeadingSigma(0.5), Orientation::kAvailable);
  EXPECT_EQ(withHeadingSigma(0.55), Orientation::kUnavailable) << "above 30 degrees";
  object.covariance.reset();
  EXPECT_EQ(trackedOf(object).orientation, Orientation::kUnavailable);
  EXPECT_EQ(matrixOfRows(trackedOf(object).pose_covariance), Matrix6d(kUnknownVariance * Matrix6d::Identity()));
}

TEST(ObjectUuid, IsThatOfTheDrivesBeginningAndTheTrackersId) {
  EXPECT_EQ(textOf(uuidOf(7, 0)), "00000000-0000-8000-8000-000000000007");
  EXPECT_EQ(textOf(uuidOf(0x1234, 1000 * 0x123'4567'89ABLL)), "00001234-5678-89ab-8000-000000001234");
  EXPECT_NE(uuidOf(7, 1'000'000'000), uuidOf(7, 2'000'000'000)) << "another pass has other objects";
  EXPECT_NE(uuidOf(7, 1'000'000'000), uuidOf(8, 1'000'000'000));
  const ros::Uuid any = uuidOf(-1, -1);
  EXPECT_EQ(any[6] >> 4, 8) << "version";
  EXPECT_EQ(any[8] >> 6, 2) << "variant";
}

ros::Detection3D detectionOfObject(const Result::Object& object) {
  return detectionsOf(bridgedResult({object}), "camera", 0).detections.at(0);
}

TEST(Detections, StandWhereTheyAreSeenFromTheCamera) {
  const Result result = bridgedResult({bridgedObject()});
  const ros::Detection3DArray message = detectionsOf(result, "base_link", 0);
  EXPECT_EQ(message.header.frame_id, "base_link");
  EXPECT_EQ(message.header.stamp.sec, 5);
  ASSERT_EQ(message.detections.size(), 1U);
  const ros::Detection3D& detection = message.detections[0];
  const SE3 T_cam_box = boxOfBridged(transformOf(result.objects[0].T_cam_body));
  const auto& [position, orientation] = detection.box_center;
  const Eigen::Quaterniond q(orientation.w, orientation.x, orientation.y, orientation.z);
  EXPECT_THAT(SE3(q.toRotationMatrix(), {position.x, position.y, position.z}), IsNearPose(T_cam_box, kRounding));
  EXPECT_EQ(detection.box_size_m.x, 5);
  EXPECT_EQ(detection.box_size_m.z, 2.2);
  EXPECT_EQ(detection.id, "00000000-0000-8000-8000-000000000007");
  for (const ros::ObjectHypothesis& hypothesis : detection.results)
    EXPECT_EQ(hypothesis.pose.position.x, position.x) << "the same for each kind";
}

TEST(Detections, HaveTheCovarianceThatFiniteDifferencesSay) {
  const Result::Object object = bridgedObject();
  const SE3 T_cam_body = transformOf(object.T_cam_body);
  const Matrix6d J = numericJacobian(
      [&](const SE3& moved) { return rosDifference(boxOfBridged(moved), boxOfBridged(T_cam_body)); }, T_cam_body);
  Matrix6d expected = J * matrixOfRows(*object.covariance) * J.transpose();
  const Eigen::Matrix3d R = T_cam_body.rotation();
  expected.topLeftCorner<3, 3>() += R * bridgedMiddle().asDiagonal() * R.transpose();
  constexpr double kTol = 1e-7;  // of central differences
  EXPECT_THAT(matrixOfRows(detectionOfObject(object).results[0].covariance), IsNear(expected, kTol));
}

TEST(Detections, HaveScoresThatSumToTheProbabilityThatTheObjectIsThere) {
  const auto results = detectionOfObject(bridgedObject()).results;
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].class_id, "car");
  EXPECT_NEAR(results[0].score, 0.75 * 0.8, kRounding);
  EXPECT_EQ(results[1].class_id, "unknown");
  EXPECT_NEAR(results[0].score + results[1].score, 0.75, kRounding);
}

TEST(Detections, LeaveOutWhatIsPredicted) {
  Result::Object seen = bridgedObject(), predicted = bridgedObject();
  predicted.state = Result::State::kPredicted;
  predicted.id = 8;
  EXPECT_EQ(detectionsOf(bridgedResult({seen, predicted}), "camera", 0).detections.size(), 1U);
}

TEST(Detections, SayThatACovarianceIsNotKnown) {
  Result::Object object = bridgedObject();
  object.covariance.reset();
  EXPECT_EQ(detectionOfObject(object).results[0].covariance, unknownCovariance());
}

using testing::ElementsAre;
using testing::IsEmpty;
using Type = ros::Marker::Type;

/// A car ahead and to the left of the camera, turned to the left, at 5 m/s.
Result::Object car(std::int64_t id) {
  Result::Object object;
  object.id = id;
  object.T_world_body = rowsByHand(turned({0, 0, kHalfTurn / 2}, {20, 3, 0}));
  object.velocity_world_mps = {0, 5, 0};
  object.box_center_body_m = {-1, 0, 0.5};
  object.box_size_m = {4, 2, 1.5};
  return object;
}

Result withObjects(std::vector<Result::Object> objects) {
  Result result;
  result.stamp_ns = 5'000'000'000;
  result.objects = std::move(objects);
  return result;
}

/// "ns id action" of each.
std::vector<std::string> lifeOf(const ros::MarkerArray& array) {
  std::vector<std::string> life;
  for (const ros::Marker& marker : array.markers)
    life.push_back(marker.ns + " " + std::to_string(marker.id) + " " +
                   std::to_string(static_cast<std::int32_t>(marker.action)));
  return life;
}

Eigen::Vector3d at(const ros::Vector3& v) { return {v.x, v.y, v.z}; }

TEST(ObjectMarkers, AreACubeALabelAndAnArrowInTheWorld) {
  ObjectMarkers markers({.frame_id = "odom", .lifetime_s = 1.5});
  markers(withObjects({}));
  const ros::MarkerArray array = markers(withObjects({car(7)}));
  ASSERT_THAT(lifeOf(array), ElementsAre("box 7 0", "label 7 0", "velocity 7 0"));
  const ros::Marker &box = array.markers[0], &label = array.markers[1], &velocity = array.markers[2];
  EXPECT_EQ(box.header.frame_id, "odom");
  EXPECT_EQ(box.header.stamp.sec, 5);
  EXPECT_EQ(box.lifetime_ns, 1'500'000'000);
  EXPECT_EQ(box.type, Type::kCube);
  EXPECT_THAT(at(box.pose.position), IsNear(Eigen::Vector3d(20, 2, 0.5), kRounding)) << "a meter behind, along -y";
  EXPECT_NEAR(box.pose.orientation.z, std::sqrt(0.5), kRounding);
  EXPECT_EQ(at(box.scale), Eigen::Vector3d(4, 2, 1.5)) << "length, width and height along the body's axes";
  EXPECT_EQ(label.type, Type::kText);
  EXPECT_EQ(label.text, "7: 5.0 m/s");
  EXPECT_GT(label.pose.position.z, 0.5 + 1.5 / 2) << "above the cube";
  EXPECT_EQ(velocity.type, Type::kArrow);
  ASSERT_EQ(velocity.points.size(), 2U);
  EXPECT_THAT(at(velocity.points[0]), IsNear(Eigen::Vector3d(20, 2, 0.5), kRounding));
  EXPECT_THAT(at(velocity.points[1]), IsNear(Eigen::Vector3d(20, 7, 0.5), kRounding)) << "where it is in a second";
  EXPECT_EQ(velocity.pose.orientation.w, 1) << "its points are in the world as they are";
}

TEST(ObjectMarkers, BeginByDeletingAllAndDeleteWhatVanished) {
  ObjectMarkers markers({.frame_id = "odom"});
  EXPECT_THAT(lifeOf(markers(withObjects({car(1), car(2)}))),
              ElementsAre(" 0 3", "box 1 0", "label 1 0", "velocity 1 0", "box 2 0", "label 2 0", "velocity 2 0"));
  EXPECT_THAT(lifeOf(markers(withObjects({car(2)}))),
              ElementsAre("box 2 0", "label 2 0", "velocity 2 0", "box 1 2", "label 1 2", "velocity 1 2"));
  EXPECT_THAT(lifeOf(markers(withObjects({car(2)}))), ElementsAre("box 2 0", "label 2 0", "velocity 2 0"))
      << "deleted once";
  EXPECT_THAT(lifeOf(markers(withObjects({}))), ElementsAre("box 2 2", "label 2 2", "velocity 2 2"));
  EXPECT_THAT(lifeOf(markers(withObjects({}))), IsEmpty());
}

TEST(ObjectMarkers, LeaveOutWhatIsNotKnownAndDeleteItWhereItWasShown) {
  ObjectMarkers markers({.frame_id = "odom"});
  markers(withObjects({car(1)}));
  Result::Object stopped = car(1);
  stopped.velocity_world_mps = {0, 0, 0};
  EXPECT_THAT(lifeOf(markers(withObjects({stopped}))), ElementsAre("box 1 0", "label 1 0", "velocity 1 2"));
  stopped.box_size_m = {0, 0, 0};
  EXPECT_THAT(lifeOf(markers(withObjects({stopped}))), ElementsAre("label 1 0", "box 1 2"));
}

TEST(ObjectMarkers, HaveTheColorOfTheirState) {
  ObjectMarkers markers({.frame_id = "odom"});
  markers(withObjects({}));
  const auto color = [&](Result::State state) {
    Result::Object object = car(1);
    object.state = state;
    const ros::Color c = markers(withObjects({object})).markers.front().color;
    return std::array{c.r, c.g, c.b, c.a};
  };
  const auto moving = color(Result::State::kMoving), stopped = color(Result::State::kStopped),
             predicted = color(Result::State::kPredicted);
  EXPECT_NE(moving, stopped);
  EXPECT_NE(moving, predicted);
  EXPECT_NE(stopped, predicted);
  EXPECT_LT(predicted[3], moving[3]) << "what is not seen is faint";
}

TEST(ObjectMarkers, HaveIdsOfThirtyTwoBits) {
  ObjectMarkers markers({.frame_id = "odom"});
  markers(withObjects({}));
  EXPECT_EQ(markers(withObjects({car((std::int64_t{1} << 31) + 5)})).markers.front().id, 5);
}

}  // namespace
}  // namespace motorcade::test
