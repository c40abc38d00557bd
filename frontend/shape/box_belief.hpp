#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "core/messages.hpp"

namespace motorcade {

/// Faces of a cuboid along the body's axes: positions of its rear, front, right, left, bottom and top [m].
using BoxFaces = Vector6d;
enum Face { kRear, kFront, kRight, kLeft, kBottom, kTop };

/// Sign of a face's outward direction: toward the greater coordinates or the lesser.
inline double outward(int face) { return face % 2 == 1 ? 1 : -1; }

/// Information on the faces, as a quadratic in them: faces^T H faces - 2 b^T faces + c. Parts of the body that were
/// seen say besides that a face lies at their place or beyond (its reach); of several the weighted mean counts.
struct FaceInformation {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double c = 0;
  Vector6d reach_weight = Vector6d::Zero(), reach_sum = Vector6d::Zero();  // 1/m^2, and weighted places

  /// Adds one measurement: row . faces = value, with a standard deviation.
  void add(const Vector6d& row, double value, double sigma);
  /// Adds that a face lies at a place or beyond.
  void addReach(int face, double at, double sigma);
  void add(const FaceInformation& more, double weight = 1);
  /// The same information in a body frame whose origin lies by `-shift` in this one.
  FaceInformation shifted(const Eigen::Vector3d& shift) const;
};

/// A Gaussian of the faces.
struct FacePosterior {
  BoxFaces faces;
  Matrix6d covariance;
  double misfit, log_determinant;  // of the information
};
/// Adds evidence to a prior. A reach counts where the face would fall short of it, and never draws a face back: how far
/// a body was seen does not tell where it ends.
FacePosterior posteriorFaces(const FaceInformation& prior, const FaceInformation& evidence);

/// Traits of a body that its followed points tell.
struct BodyTraits {
  double speed_mps = 0;
  Eigen::Vector3d least_size_m = Eigen::Vector3d::Zero();  // along its axes, as its points are so far apart
};

/// The cuboid by the evidence and by what is usual for some kind of object.
struct BoxEstimate {
  BoxFaces faces = BoxFaces::Zero();
  Matrix6d covariance = Matrix6d::Identity();
  ObjectKind kind = ObjectKind::kUnknown;

  Eigen::Vector3d least() const { return {faces[kRear], faces[kRight], faces[kBottom]}; }
  Eigen::Vector3d most() const { return {faces[kFront], faces[kLeft], faces[kTop]}; }
  /// Volumes that the cuboid may fill: those of all kinds that are not ruled out, with a standard deviation to each
  /// side. `usual` is that of the likeliest kind and of a car, unless the kind is known to be smaller.
  Eigen::Vector3d usual_least = Eigen::Vector3d::Zero(), usual_most = Eigen::Vector3d::Zero();
  Eigen::Vector3d possible_least = Eigen::Vector3d::Zero(), possible_most = Eigen::Vector3d::Zero();
  ObjectBox box() const;
  /// Extends the volumes to a part of the body, along the axes on which it has a size.
  void reach(const Eigen::AlignedBox3d& part);
};

/// Estimates the cuboid by a mixture of Gaussians. Each kind's usual size closes what the evidence leaves open (hidden
/// faces), and its fit to the evidence and to the speed tells the kind. The likeliest one, or the likeliest of a known
/// kind, gives the cuboid. Sizes are the published means of KITTI's classes. Standard deviations are those of
/// independent looks; `believedBox` has those that remain. What is known to walk or ride fills no more than a volume of
/// its kind.
BoxEstimate estimateBox(const FaceInformation& evidence, const BodyTraits& traits,
                        ObjectKind known = ObjectKind::kUnknown);

}  // namespace motorcade
