#pragma once

#include <filesystem>

#include "core/timestamp.hpp"
#include "io/bag/bag_topics.hpp"
#include "io/messages/image_message.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// A bag's drive as known before its first pair is followed.
struct BagDrive {
  Sequence sequence{};  // all but the frames and their times
  ImageTopics topics{};
  MessageConversion conversion{};  // of both sides' images
  double rate_hz = 0;              // by the median of the first periods
  Timestamp first{};               // of the first pair
};

/// Reads a bag up to its first pairs, and to both cameras' camera_info unless the user gives the calibration. Throws
/// InputError. Throws UsageError where `topics`, as the user wrote them, are empty or not among the bag's; the message
/// then lists the bag's topics.
BagDrive openBagDrive(const std::filesystem::path& bag, const std::string& topics, const GivenCameras& given);

}  // namespace motorcade
