#pragma once

#include <sensor_msgs.h>

#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"

/// Images and camera_info as the stages take them, from the types that idlc makes of apps/bridge/idl. Pixels stay those
/// of what is given.
namespace motorcade {

ImageMessage imageMessageOf(const sensor_msgs_msg_dds__Image_& sample);
CompressedImageMessage imageMessageOf(const sensor_msgs_msg_dds__CompressedImage_& sample);
/// Coefficients beyond those that a model can have are left out but for one, which is refused by whoever reads them.
CameraInfoMessage cameraInfoMessageOf(const sensor_msgs_msg_dds__CameraInfo_& sample);

}  // namespace motorcade
