#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "io/bag/bag_image.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/bag_topics.hpp"
#include "io/messages/camera_info_message.hpp"
#include "io/messages/stamp_pairing.hpp"

namespace motorcade {

using BagPair = StampPairing<BagImage>::Pair;

/// The pairs of images of a bag in the order of their stamps, which are the left images'. One thread reads.
class BagPairs {
 public:
  /// Tolerance of a pair's stamps. Cameras with a common trigger have the same stamps, or differ by their drivers'
  /// delay. In 5 ms a car at 20 m/s drives a decimeter.
  static constexpr std::int64_t kTolerance_ns = 5'000'000;

  enum class Infos { kTake, kLeaveOut };
  /// Throws InputError, and UsageError where the bag lists its topics and these are not among them.
  BagPairs(const std::filesystem::path& bag, const ImageTopics& topics, Infos infos);

  /// The next pair; empty after the last one. Throws InputError where the bag is damaged; what came before is good.
  std::optional<BagPair> next();

  BagReader& bag() { return *bag_; }
  /// The first camera_info of a side that came so far.
  const std::optional<CameraInfoMessage>& info(StereoSide side) const { return infos_[indexOf(side)]; }
  /// Images of a side that came.
  std::size_t images(StereoSide side) const { return images_[indexOf(side)]; }
  /// The least difference between an image's stamp and that of the other side's last one; empty where there are none.
  std::optional<std::int64_t> nearest_ns() const { return nearest_ns_; }
  /// A sentence about the images that belong to no pair; empty where there are none. Call it at the end.
  std::string remark() const;

 private:
  void requireListed();
  std::optional<BagPair> take(const BagMessage& message);
  void takeInfo(const BagMessage& message, StereoSide side);
  void noteDistance(StereoSide side, std::int64_t stamp_ns);
  std::int64_t withoutPartner(StereoSide side) const;

  std::string name_;
  ImageTopics topics_;
  std::array<std::string, 2> info_topics_{};  // empty where none is to be read
  std::unique_ptr<BagReader> bag_;
  StampPairing<BagImage> pairing_{{.tolerance_ns = kTolerance_ns}};
  std::array<std::optional<CameraInfoMessage>, 2> infos_{};
  std::array<std::size_t, 2> images_{};
  std::array<std::optional<std::int64_t>, 2> stamps_ns_{};  // of each side's last image
  std::optional<std::int64_t> nearest_ns_{};
  std::size_t late_ = 0;  // pairs that are no later than one before them
  std::optional<std::int64_t> last_ns_{};
};

}  // namespace motorcade
