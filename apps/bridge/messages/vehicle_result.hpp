#pragma once

#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Converts a result of the camera to one of the vehicle that carries it. Its "cam" is the vehicle's frame, its "world"
/// that frame in the first pair. With M = T_vehicle_cam,
///   T_world_vehicle = M T_world_cam M^-1,   T exp(xi) becomes M T exp(xi) M^-1 = T_world_vehicle exp(Ad(M) xi),
/// so Ad(M) carries motions and twists, and Ad(M) C Ad(M)' their covariances. An object's covariance stays, as it is of
/// a perturbation in the body's own axes.
Result seenFromVehicle(Result result, const SE3& T_vehicle_cam);

}  // namespace motorcade
