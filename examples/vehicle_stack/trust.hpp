#pragma once

#include <motorcade/motorcade.hpp>

#include "health_monitor.hpp"

namespace vehicle_stack {

/// What a message is worth, in order. Each message says it, so that whoever reads needs no memory of others.
enum class Trust {
  kMeasured,   // seen in this frame, by a tracker that is healthy
  kUncertain,  // measured, but less surely: keep twice the distance
  kPredicted,  // not seen in this frame: carried on from those before, for a second at most
  kNone,       // must not be used
};
const char* nameOf(Trust trust);

/// Of a whole frame, at the level that the health monitor is at.
Trust trustIn(const motorcade::Result& result, Level level);
/// Of an object in it: never more than of the frame.
Trust trustIn(const motorcade::Result::Object& object, Trust in_frame);

}  // namespace vehicle_stack
