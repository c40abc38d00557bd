#pragma once

#include <geometry_msgs.h>
#include <sensor_msgs.h>

#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"
#include "motorcade/motorcade.hpp"

/// Images, camera_info and the vehicle's own motion as the stages take them, from the types that idlc makes of
/// apps/bridge/idl. Pixels stay those of what is given.
namespace motorcade {

ImageMessage imageMessageOf(const sensor_msgs_msg_dds__Image_& sample);
CompressedImageMessage imageMessageOf(const sensor_msgs_msg_dds__CompressedImage_& sample);
/// Coefficients beyond those that a model can have are left out but for one, which is refused by whoever reads them.
CameraInfoMessage cameraInfoMessageOf(const sensor_msgs_msg_dds__CameraInfo_& sample);
/// The speed along the vehicle's x axis and the turn rate about z, with their deviations where the covariance has them.
VehicleMotion vehicleMotionOf(const geometry_msgs_msg_dds__TwistWithCovarianceStamped_& sample);

}  // namespace motorcade
