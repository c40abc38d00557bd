#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/timestamp.hpp"
#include "io/bag/bag_pairing.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/bag_topics.hpp"
#include "io/messages/camera_info_message.hpp"

namespace motorcade {

/// The pairs of images of a bag in the order of their stamps, which are the left images'. One thread reads.
class BagPairs {
 public:
  enum class Infos { kTake, kLeaveOut };
  /// Throws InputError, and UsageError where the bag lists its topics and these are not among them.
  BagPairs(const std::filesystem::path& bag, const ImageTopics& topics, Infos infos);

  /// The next pair; empty after the last one. Throws InputError where the bag is damaged; what came before is good.
  std::optional<BagPair> next();

  BagReader& bag() { return *bag_; }
  /// The first camera_info of a side that came so far.
  const std::optional<CameraInfoMessage>& info(StereoSide side) const { return infos_[place(side)]; }
  /// Images of a side that came.
  std::size_t images(StereoSide side) const { return images_[place(side)]; }
  const BagPairing& pairing() const { return pairing_; }
  /// A sentence about the images that belong to no pair; empty where there are none. Call it at the end.
  std::string remark() const;

 private:
  static std::size_t place(StereoSide side) { return side == StereoSide::kLeft ? 0 : 1; }
  void requireListed();
  std::optional<BagPair> take(const BagMessage& message);
  void takeInfo(const BagMessage& message, StereoSide side);

  std::string name_;
  ImageTopics topics_;
  std::array<std::string, 2> info_topics_{};  // empty where none is to be read
  std::unique_ptr<BagReader> bag_;
  BagPairing pairing_;
  std::array<std::optional<CameraInfoMessage>, 2> infos_{};
  std::array<std::size_t, 2> images_{};
  std::size_t late_ = 0;  // pairs that are no later than one before them
  std::optional<std::int64_t> last_ns_{};
};

}  // namespace motorcade
