#pragma once

#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// A result of the camera as one of the vehicle that carries it: its "cam" is the vehicle's frame, its "world" that
/// frame in the first pair. With M = T_vehicle_cam,
///   T_world_vehicle = M T_world_cam M^-1,   T exp(xi) becomes M T exp(xi) M^-1 = T_world_vehicle exp(Ad(M) xi),
/// so that motions and twists are carried by Ad(M), and their covariances by Ad(M) C Ad(M)'. An object's covariance
/// stays, as it is of a perturbation in the body's own axes.
Result seenFromVehicle(Result result, const SE3& T_vehicle_cam);

}  // namespace motorcade
