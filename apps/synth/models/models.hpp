#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

/// Models of what there is in a scene. Origins are on the ground; x runs along the street.
namespace motorcade::synth {

/// Vehicles of some thirty parts each: body, cabin, bumpers, lights, plates, wheels, mirrors, ... Sizes, colors, plates
/// and stickers follow the seed.
enum class VehicleKind { kCar, kVan, kTruck };
/// Finish in place of paint with dirt in a tone of the seed's choice: smooth, or dark, or both.
enum class Finish { kAny, kDark, kSmoothDark, kSmoothLight };
Model makeVehicle(VehicleKind kind, std::uint32_t seed, Finish finish = Finish::kAny);

/// A city bus of two axles, 12 m long.
Model makeBus(std::uint32_t seed);
/// A box on two axles close together, with a drawbar; follows a truck.
Model makeTrailer(std::uint32_t seed);

/// A person who walks: legs and arms swing with the distance covered. Size, clothes and bags follow the seed.
Model makePedestrian(std::uint32_t seed);

/// A bicycle with its rider: wheels and cranks turn, legs follow the pedals.
Model makeCyclist(std::uint32_t seed);

// Objects along a street.

Model makeBuilding(float length_m, float depth_m, float height_m, std::uint32_t seed);
Model makeTree(float height_m, std::uint32_t seed);
Model makeBush(float length_m, std::uint32_t seed);
Model makeHedge(float length_m, float height_m, std::uint32_t seed);
/// Posts with rails, or boards.
Model makeFence(float length_m, std::uint32_t seed);
Model makeLampPost(std::uint32_t seed);
Model makeTrafficSign(std::uint32_t seed);
Model makeGuardRail(float length_m, std::uint32_t seed);
/// Bins, boxes and posts: small things on the pavement.
Model makeStreetClutter(std::uint32_t seed);

// Gardens: fences, and trees in wind.

/// Thin pickets on two rails; what is behind shows through the gaps.
Model makePicketFence(float length_m, std::uint32_t seed);
/// A tree with fine leaves whose crown sways, by 3 cm at its lower branches and 15 cm at its top.
Model makeSwayingTree(float height_m, std::uint32_t seed);

// Houses whose surfaces repeat.

/// A low house under a hipped roof of tiles that reaches down to 2.7 m; windows between slatted shutters on all sides.
Model makeCottage(float length_m, float depth_m, std::uint32_t seed);
/// A row of brick houses: pillars, windows and ledges repeat every 4 m. Rows of a multiple of 4 m join without a seam.
Model makeTerrace(float length_m, float depth_m, float height_m, float tone);

/// Gives the model the smallest box about its origin that holds all parts. If limbs move, it holds them at every point
/// of a cycle of `cycle_m`.
void fitBox(Model& model, double cycle_m = 0);

}  // namespace motorcade::synth
