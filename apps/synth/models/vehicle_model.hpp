#pragma once

#include "apps/synth/shapes/noise.hpp"
#include "apps/synth/shapes/primitive.hpp"

namespace motorcade::synth {

/// Vehicles of some thirty parts each: body, cabin, bumpers, lights, plates, wheels, mirrors, ... Sizes, colors, plates
/// and stickers follow the seed.
enum class VehicleKind { kCar, kVan, kTruck };
/// Finish in place of paint with dirt in a tone of the seed's choice: smooth, or dark, or both.
enum class Finish { kAny, kDark, kSmoothDark, kSmoothLight };
Model makeVehicle(VehicleKind kind, std::uint32_t seed, Finish finish = Finish::kAny);

}  // namespace motorcade::synth
