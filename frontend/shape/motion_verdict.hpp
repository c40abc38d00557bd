#pragma once

#include "core/messages.hpp"
#include "frontend/shape/existence.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Tells whether the image around an object's followed points moved with the body since an earlier frame, or rested.
/// Each point asks the surface around it, densely. That the point itself was followed does not count: a wrong match on
/// what repeats was followed, too. Where a point may lie on an object that was known before, what goes along with that
/// one stands in for what rests. A person with hardly a followed point is asked by its patches, of which most must
/// tell. `observed` is null where the object was not measured, `disparities` where no outline of it was found; the
/// frame compared with is `view.well_before`.
MotionVerdict motionVerdict(const ObjectObservation* observed, const LevelDisparities* disparities,
                            const ObjectView& view, const StereoCamera& camera);

}  // namespace motorcade
