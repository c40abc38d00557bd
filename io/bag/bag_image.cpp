#include "io/bag/bag_image.hpp"

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMost_bytes = std::size_t{64} << 20;  // as several images wait for their partners

}  // namespace

BagImage::BagImage(const std::string& bag, const BagTopic& topic, const BagMessage& message)
    : name_(bag + ": " + message.place + ", " + printable(topic.name, 80)) {
  const auto kind = sensorMessageNamed(topic.type);
  if (!kind || *kind == SensorMessage::kCameraInfo)
    throw InputError(name_ + ": is of type " + printable(topic.type) +
                     "; sensor_msgs' Image and CompressedImage are read, and foxglove's RawImage and CompressedImage");
  const auto format = wireFormatNamed(topic.encoding);
  if (!format)
    throw InputError(name_ + ": is encoded as '" + printable(topic.encoding) +
                     "'; cdr (ROS 2), ros1 and protobuf are read");
  kind_ = *kind, format_ = *format;
  if (message.data.size() > kMost_bytes)
    throw InputError(name_ + ": has " + std::to_string(message.data.size()) + " bytes, " + std::to_string(kMost_bytes) +
                     " at most are read of an image");
  message_.assign(message.data.begin(), message.data.end());
  stamp_ns = stampOfMessage(reader());
  if (stamp_ns == 0) stamp_ns = message.log_ns;
}

ImageHeader BagImage::header() const {
  return kind_ == SensorMessage::kImage ? imageHeaderOf(readImageMessage(reader()), name_)
                                        : imageHeaderOf(readCompressedImageMessage(reader()), name_);
}

int BagImage::brightestSample() const {
  return kind_ == SensorMessage::kImage ? brightestSampleOf(readImageMessage(reader()), name_)
                                        : brightestSampleOf(readCompressedImageMessage(reader()), name_);
}

Image BagImage::gray(ImagePool& pool, const MessageConversion& conversion) const {
  return kind_ == SensorMessage::kImage ? grayImageOf(readImageMessage(reader()), name_, pool, conversion)
                                        : grayImageOf(readCompressedImageMessage(reader()), name_, pool, conversion);
}

}  // namespace motorcade
