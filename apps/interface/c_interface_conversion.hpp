#pragma once

#include "motorcade/motorcade.h"
#include "motorcade/motorcade.hpp"

struct motorcade_result {  // NOLINT(readability-identifier-naming): a name of the C interface
  motorcade::Result result;
};

namespace motorcade {

/// The caller's structs in C++. Each throws `Error`, naming the member.
Camera cameraOf(const motorcade_camera* given);
Tracker::Options optionsOf(const motorcade_options* given);
Pair pairOf(const motorcade_pair* given);
VehicleMotion motionOf(const motorcade_vehicle_motion* given);

motorcade_options defaultOptions();
motorcade_pair defaultPair();

/// Converts results to C. Texts and masks remain those of the argument.
motorcade_frame frameOf(const Result& result);
motorcade_object objectOf(const Result::Object& object);
motorcade_mask maskOf(const Result::Mask& mask);
motorcade_push pushOf(const Tracker::Push& push);
motorcade_counts countsOf(const Tracker::Counts& counts);
motorcade_camera cCameraOf(const Camera& camera);  // without its rig
motorcade_image cImageOf(const Pair::Image& image);

}  // namespace motorcade
