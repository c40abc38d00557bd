#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/bridge/dds/dds_publisher.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_markers.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Turns the results of one tracker into the requested messages, and publishes them. Call it in frame order.
class ResultPublisher {
 public:
  struct Params {
    FrameIds ids{};
    SE3 T_child_cam{};    // where the camera sits in what `ids.child` names
    std::string drive{};  // in diagnostics, the hardware's name
    double marker_lifetime_s = 1;
  };
  ResultPublisher(DdsPublisher& out, const Params& params);
  void publish(const Result& result);

 private:
  DdsPublisher& out_;
  Params params_;
  ObjectMarkers markers_;
  std::optional<std::int64_t> first_stamp_ns_{};
};

}  // namespace motorcade
