#pragma once

#include <geometry_msgs.h>
#include <sensor_msgs.h>

#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"
#include "motorcade/motorcade.hpp"

/// Converts the types that idlc makes of apps/bridge/idl to images, camera_info and the vehicle's own motion. Pixels
/// stay those of the argument.
namespace motorcade {

ImageMessage imageMessageOf(const sensor_msgs_msg_dds__Image_& sample);
CompressedImageMessage imageMessageOf(const sensor_msgs_msg_dds__CompressedImage_& sample);
/// Keeps one coefficient more than a model can have, so that readers refuse the message, and drops the others.
CameraInfoMessage cameraInfoMessageOf(const sensor_msgs_msg_dds__CameraInfo_& sample);
/// The speed along the vehicle's x axis and the turn rate about z, with their deviations where the covariance has them.
VehicleMotion vehicleMotionOf(const geometry_msgs_msg_dds__TwistWithCovarianceStamped_& sample);

}  // namespace motorcade
