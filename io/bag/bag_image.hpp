#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/sensor_messages.hpp"
#include "io/messages/image_message.hpp"

namespace motorcade {

/// An image's message, taken out of a bag to wait for its partner. Throws InputError naming the message.
class BagImage {
 public:
  /// `bag` is the file's name. A message without a time in its head has that of its recording.
  BagImage(const std::string& bag, const BagTopic& topic, const BagMessage& message);

  std::int64_t stamp_ns() const { return stamp_ns_; }
  std::size_t bytes() const { return message_.size(); }
  const std::string& name() const { return name_; }

  ImageHeader header() const;
  int brightestSample() const;
  Image gray(ImagePool& pool, const MessageConversion& conversion) const;

 private:
  WireReader reader() const { return {message_, format_, name_}; }

  std::string name_;
  SensorMessage kind_ = SensorMessage::kImage;
  WireFormat format_ = WireFormat::kCdr;
  std::vector<std::uint8_t> message_;
  std::int64_t stamp_ns_ = 0;
};

}  // namespace motorcade
