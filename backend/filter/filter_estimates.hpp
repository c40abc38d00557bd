#pragma once

#include "backend/filter/object_filter.hpp"
#include "backend/motion/camera_path.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// What a filtering back-end publishes of a camera whose odometry is chained: as yet without objects.
FrameEstimate cameraEstimate(const FrameMeasurements& measurements, const CameraPath& path);
/// And of an object, from a filter at the observation's time.
ObjectEstimate objectEstimate(const ObjectObservation& observation, const ObjectFilter& filter);

}  // namespace motorcade
