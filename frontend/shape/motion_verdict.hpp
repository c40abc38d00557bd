#pragma once

#include <span>

#include "core/messages.hpp"
#include "frontend/shape/existence.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Did the image around an object's followed points move with the body since an earlier frame, or did it rest? Each
/// point asks the surface around it, densely: that it was itself followed along with the body does not count, as a
/// wrong match on what repeats was, too. `view.well_before` is known.
MotionVerdict motionVerdict(std::span<const PointMeasurement> points, const LevelDisparities& disparities,
                            const ObjectView& view, const StereoCamera& camera);

}  // namespace motorcade
