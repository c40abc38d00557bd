#pragma once

#include <optional>

#include "core/messages.hpp"

namespace motorcade {

/// Faces of a cuboid along the body's axes: where its rear, front, right, left, bottom and top are [m].
using BoxFaces = Vector6d;
enum Face { kRear, kFront, kRight, kLeft, kBottom, kTop };

/// What is known of the faces, as a quadratic in them: faces^T H faces - 2 b^T faces + c.
struct FaceInformation {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double c = 0;

  /// One measurement: row . faces = value, with a standard deviation.
  void add(const Vector6d& row, double value, double sigma);
  void add(const FaceInformation& more, double weight = 1);
  /// The same knowledge in a body frame whose origin lies by `-shift` in this one.
  FaceInformation shifted(const Eigen::Vector3d& shift) const;
};

/// The cuboid that the evidence and what is usual for some kind of object say.
struct BoxEstimate {
  BoxFaces faces = BoxFaces::Zero();
  Matrix6d covariance = Matrix6d::Identity();
  ObjectKind kind = ObjectKind::kUnknown;

  Eigen::Vector3d least() const { return {faces[kRear], faces[kRight], faces[kBottom]}; }
  Eigen::Vector3d most() const { return {faces[kFront], faces[kLeft], faces[kTop]}; }
  /// The volume that the cuboid may fill: of all kinds that are not ruled out, with a standard deviation to each side.
  /// `usual` is that of the likeliest kind and of a car, unless the kind is known to be smaller.
  Eigen::Vector3d usual_least = Eigen::Vector3d::Zero(), usual_most = Eigen::Vector3d::Zero();
  Eigen::Vector3d possible_least = Eigen::Vector3d::Zero(), possible_most = Eigen::Vector3d::Zero();
  ObjectBox box() const;
};

/// Each kind's usual size closes what the evidence leaves open (hidden faces), and its fit to the evidence and to the
/// speed tells the kind: a mixture of Gaussians, of which the likeliest gives the cuboid, or the likeliest of a kind
/// that is known. The sizes are the published means of KITTI's classes. Standard deviations are those of independent
/// looks; `believedBox` has those that remain. What is known to walk or ride fills no more than a volume of its kind.
BoxEstimate estimateBox(const FaceInformation& evidence, double speed_mps, ObjectKind known = ObjectKind::kUnknown);

}  // namespace motorcade
