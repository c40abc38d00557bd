#pragma once

#include "core/messages.hpp"
#include "frontend/shape/existence.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Did the image around an object's followed points move with the body since an earlier frame, or did it rest? Each
/// point asks the surface around it, densely: that it was itself followed along with the body does not count, as a
/// wrong match on what repeats was, too. Where a point may lie on an object that was known before, what goes along with
/// that one stands in for what rests. A person of whom hardly a point is followed is asked by its patches, of which
/// most must tell. `observed` is null where the object was not measured, `disparities` where no outline of it was
/// found; the frame compared with is `view.well_before`.
MotionVerdict motionVerdict(const ObjectObservation* observed, const LevelDisparities* disparities,
                            const ObjectView& view, const StereoCamera& camera);

}  // namespace motorcade
