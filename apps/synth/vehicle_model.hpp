#pragma once

#include "apps/synth/noise.hpp"
#include "apps/synth/primitive.hpp"

namespace motorcade::synth {

/// Vehicles of some thirty parts each: body, cabin, bumpers, lights, plates, wheels, mirrors, ... Sizes, colors, plates
/// and stickers follow the seed.
enum class VehicleKind { kCar, kVan, kTruck };
Model makeVehicle(VehicleKind kind, std::uint32_t seed);

}  // namespace motorcade::synth
