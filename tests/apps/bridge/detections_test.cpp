#include "apps/bridge/messages/detections.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "apps/bridge/messages/message_conversion.hpp"
#include "tests/apps/bridge/bridged_object_by_hand.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade::test {
namespace {

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

}  // namespace
}  // namespace motorcade::test
