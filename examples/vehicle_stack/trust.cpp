#include "trust.hpp"

#include <algorithm>

namespace vehicle_stack {

using motorcade::Result;

const char* nameOf(Trust trust) {
  switch (trust) {
    case Trust::kMeasured:
      return "measured";
    case Trust::kUncertain:
      return "uncertain";
    case Trust::kPredicted:
      return "predicted";
    case Trust::kNone:
      return "none";
  }
  return "none";
}

Trust trustIn(const Result& result, Level level) {
  if (level == Level::kStarting || level == Level::kBlind) return Trust::kNone;
  if (result.status != Result::Status::kGood) return Trust::kPredicted;
  if (!result.problem.empty()) return Trust::kNone;  // the rig is not what its calibration says, or a stage failed
  if (result.cause != Result::Cause::kNone || level == Level::kDegraded) return Trust::kUncertain;
  return Trust::kMeasured;
}

Trust trustIn(const Result::Object& object, Trust in_frame) {
  if (object.state == Result::State::kPredicted) return std::max(in_frame, Trust::kPredicted);
  if (!object.covariance) return std::max(in_frame, Trust::kUncertain);
  return in_frame;
}

}  // namespace vehicle_stack
