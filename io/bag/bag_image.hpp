#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/sensor_messages.hpp"
#include "io/messages/image_message.hpp"

namespace motorcade {

/// A message with an image, copied from a bag to wait for its partner. Throws InputError naming the message.
class BagImage {
 public:
  BagImage() = default;
  /// `bag` is the file's name. A message without a time in its header takes that of its recording.
  BagImage(const std::string& bag, const BagTopic& topic, const BagMessage& message);

  const std::string& name() const { return name_; }

  ImageHeader header() const;
  int brightestSample() const;
  Image gray(ImagePool& pool, const MessageConversion& conversion) const;

  std::int64_t stamp_ns = 0;

 private:
  WireReader reader() const { return {message_, format_, name_}; }

  std::string name_;
  SensorMessage kind_ = SensorMessage::kImage;
  WireFormat format_ = WireFormat::kCdr;
  std::vector<std::uint8_t> message_;
};

}  // namespace motorcade
