#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/synth/shapes/vec3.hpp"
#include "core/se3.hpp"

namespace motorcade::synth {

enum class Material : std::uint8_t {
  kPaint,
  kCabin,
  kGlass,
  kTire,
  kPlastic,
  kChrome,
  kHeadLamp,
  kTailLamp,
  kPlate,
  kGrille,
  kCargo,
  kCoach,  // vehicles
  kBrick,
  kPlaster,
  kRoof,
  kConcrete,
  kMetal,
  kWood,
  kSign,
  kBark,
  kLeaves,
  kHedge,
  kBrickwork,
  kTiles,
  kSlats,
  kPane,
  kFoliage,
  kBonnet,  // street
  kCloth,
  kSkin,  // people
};

enum class Shape : std::uint8_t { kBlock, kCylinder, kEllipsoid };

/// A half space normal * p <= offset.
struct Cut {
  Vec3 normal;
  float offset = 0;
};

/// A solid inscribed in the box [lo, hi] of its model's frame: the box itself less its model's cuts [first_cut,
/// first_cut + cuts), a capped elliptic cylinder along `axis`, or an ellipsoid.
struct Primitive {
  Shape shape = Shape::kBlock;
  Material material = Material::kConcrete;
  std::uint8_t axis = 2, cuts = 0;
  std::uint16_t first_cut = 0;
  Vec3 lo, hi;
  float tone = 0.5F;  // reflectance of its main color
  float hole = 0;     // of a cylinder: inner radius over outer radius
  std::uint32_t seed = 0;
};

struct Model;

/// A rigid part that turns on a thing as the thing moves on: a leg, a crank, a wheel with spokes. The branches of a
/// tree in wind take the time in place of the distance.
struct Limb {
  /// Position of its origin, the joint, and its angle about the y axis, from z towards x.
  struct Pose {
    Vec3 joint;
    double angle_rad = 0;
  };
  std::shared_ptr<const Model> model;
  std::function<Pose(double driven_m)> pose;

  SE3 T_parent_limb(double driven_m) const;
};

/// A thing of several parts, rigid but for its limbs: x ahead, y left, z up, origin on the ground below its center (of
/// a limb: at its joint).
struct Model {
  std::vector<Primitive> parts;
  std::vector<Cut> cuts;
  std::vector<Limb> limbs;
  float length_m = 0, width_m = 0, height_m = 0;
  std::string kitti_type;     // as in KITTI's labels, or Bus or Trailer; empty for what is not an object
  bool sways = false;         // limbs move with the time [s], not with the way driven
  bool smooth_paint = false;  // without texture; shows the surroundings as in a mirror

  Primitive& add(Material material, const Vec3& lo, const Vec3& hi, float tone, std::uint32_t seed = 0);
  Primitive& addCylinder(Material material, int axis, const Vec3& lo, const Vec3& hi, float tone,
                         std::uint32_t seed = 0);
  Primitive& addEllipsoid(Material material, const Vec3& center, const Vec3& radii, float tone, std::uint32_t seed = 0);
  /// Cuts the block that was added last by the plane through `point`; the side to which `normal` points is removed.
  void cutLast(const Vec3& normal, const Vec3& point);
  /// A square bar in a plane of constant y.
  Primitive& addBar(Material material, const Vec3& from, const Vec3& to, float thickness, float tone);
  void addLimb(Model limb, std::function<Limb::Pose(double driven_m)> pose);
};

struct SurfaceHit {
  float t = 0;
  Vec3 normal;
};

/// First intersection of the ray with a part in (t_min, t_max), all in the model's frame.
std::optional<SurfaceHit> intersect(const Primitive& part, const Cut* cuts, const Vec3& origin, const Vec3& direction,
                                    float t_min, float t_max);

/// Points on the part whose convex hull holds it: tight for blocks, within 1 % of the radius for round parts.
std::vector<Vec3> hullPoints(const Primitive& part, const Cut* cuts);

}  // namespace motorcade::synth
