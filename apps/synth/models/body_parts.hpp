#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Parts of people, on foot and on a bicycle.
namespace motorcade::synth {

/// A person's size and clothes. Lengths of the segments are shares of the height: Drillis and Contini, "Body segment
/// parameters", 1966.
struct Body {
  float height = 1.75F;
  float shirt = 0.3F, trousers = 0.1F, shoes = 0.05F, skin = 0.3F, hair = 0.05F;
  std::uint32_t seed = 0;

  float thigh() const { return 0.245F * height; }
  float shin() const { return 0.246F * height; }
  float foot() const { return 0.039F * height; }  // sole to ankle
  float heel() const { return -0.040F * height; }
  float toe() const { return 0.112F * height; }
  float upperArm() const { return 0.186F * height; }
  float forearm() const { return 0.146F * height; }
  float hipSide() const { return 0.052F * height; }
  float shoulderSide() const { return 0.130F * height; }
  float shoulder() const { return 0.288F * height; }  // above the hips
  float neck() const { return 0.335F * height; }
};
Body makeBody(std::uint32_t seed);

/// Angles of a leg or an arm. `raised_rad` turns the first segment ahead from hanging down. `bent_rad` turns the second
/// one back against the first, or ahead for an arm. `toes_down_rad` turns a foot's toes down against the shin.
struct Pose {
  Vec3 joint;  // hip or shoulder
  double raised_rad = 0, bent_rad = 0, toes_down_rad = 0;
};
using PoseAt = std::function<Pose(double driven_m)>;

/// The body from the hips up to the neck; arms and head are its limbs.
Model makeTrunk(const Body& body);
/// Origin at the neck.
Model makeHead(const Body& body, bool helmet);
void addLeg(Model& model, const Body& body, const PoseAt& pose);
void addArm(Model& model, const Body& body, const PoseAt& pose);

/// Raises and bends two segments so that the end of the second one, which starts at `joint`, is at `end`; stretches
/// them when it is too far. The middle joint is ahead of the line for a leg, behind it for an arm.
Pose reaching(const Vec3& joint, const Vec3& end, float first_m, float second_m, bool arm);

}  // namespace motorcade::synth
