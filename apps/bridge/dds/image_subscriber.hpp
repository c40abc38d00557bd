#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "apps/bridge/dds/dds_configuration.hpp"
#include "apps/bridge/messages/pair_conversion.hpp"
#include "io/messages/camera_info_message.hpp"
#include "io/sequence/sequence.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Receives two cameras' images and camera_info, and the vehicle's own motion where that is wanted. A name that ends in
/// `/compressed` is that of a sensor_msgs/CompressedImage, another one of a sensor_msgs/Image. A DdsPublisher must have
/// made the place's DDS domain. For one thread.
class ImageSubscriber {
 public:
  struct Params {
    std::array<CameraTopics, 2> topics{};
    std::string vehicle_motion{};  // topic of a geometry_msgs/TwistWithCovarianceStamped; empty: none
    /// Best effort, which understands reliable publishers too: of what waits, the last images are kept. Or reliable,
    /// which understands those alone: a publisher waits for room.
    bool every_image = false;
  };
  /// Throws OutputError.
  ImageSubscriber(const DdsPlace& place, const Params& params);
  ~ImageSubscriber();
  ImageSubscriber(const ImageSubscriber&) = delete;
  ImageSubscriber& operator=(const ImageSubscriber&) = delete;

  /// Returns when there is something to be taken, or after so long.
  void wait(std::chrono::milliseconds patience) const;
  /// The oldest image that waits.
  std::optional<ReceivedImage> takeImage(StereoSide side);
  /// The newest camera_info that came since the last call.
  std::optional<CameraInfoMessage> takeInfo(StereoSide side);
  /// The oldest that waits.
  std::optional<VehicleMotion> takeMotion();
  /// The number of current publishers of the image topic, with its type.
  int publishers(StereoSide side) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The type of an image topic's messages: `sensor_msgs/Image`.
std::string imageTypeOf(const std::string& topic);

}  // namespace motorcade
