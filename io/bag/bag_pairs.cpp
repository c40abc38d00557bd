#include "io/bag/bag_pairs.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/messages/camera_info_message.hpp"

namespace motorcade {

BagPairs::BagPairs(const std::filesystem::path& bag, const ImageTopics& topics, Infos infos)
    : name_(bag.string()), topics_(topics), bag_(openBag(bag)) {
  if (infos == Infos::kTake) info_topics_ = {cameraInfoTopicOf(topics.left), cameraInfoTopicOf(topics.right)};
  requireListed();
  bag_->select({topics.left, topics.right, info_topics_[0], info_topics_[1]});
}

void BagPairs::requireListed() {
  if (bag_->topics().empty()) return;
  for (const std::string& name : {topics_.left, topics_.right})
    if (std::ranges::find(bag_->topics(), name, &BagTopic::name) == bag_->topics().end())
      failWithTopics(*bag_, name_ + ": has no topic " + printable(name, 200));
}

std::optional<BagPair> BagPairs::next() {
  while (const auto message = bag_->next())
    if (auto pair = take(*message)) return pair;
  return std::nullopt;
}

/// Returns the pair that a message completes. Drops a pair that is no later than the previous one.
std::optional<BagPair> BagPairs::take(const BagMessage& message) {
  const BagTopic& topic = bag_->topics()[message.topic];
  const bool left = topic.name == topics_.left;
  if (!left && topic.name != topics_.right) {
    takeInfo(message, topic.name == info_topics_[0] ? StereoSide::kLeft : StereoSide::kRight);
    return std::nullopt;
  }
  const StereoSide side = left ? StereoSide::kLeft : StereoSide::kRight;
  ++images_[indexOf(side)];
  BagImage image(name_, topic, message);
  noteDistance(side, image.stamp_ns);
  auto pair = pairing_.add(side, std::move(image));
  if (!pair) return std::nullopt;
  const std::int64_t stamp_ns = pair->left.stamp_ns;
  if (last_ns_ && stamp_ns <= *last_ns_) {
    ++late_;
    return std::nullopt;
  }
  last_ns_ = stamp_ns;
  return pair;
}

/// Stamps from unknown sources may have any value. A difference that overflows counts as the largest.
void BagPairs::noteDistance(StereoSide side, std::int64_t stamp_ns) {
  stamps_ns_[indexOf(side)] = stamp_ns;
  const auto other_ns = stamps_ns_[indexOf(otherThan(side))];
  if (!other_ns) return;
  const std::uint64_t apart_ns = static_cast<std::uint64_t>(std::max(stamp_ns, *other_ns)) -
                                 static_cast<std::uint64_t>(std::min(stamp_ns, *other_ns));
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  nearest_ns_ = std::min(nearest_ns_.value_or(kMost),
                         static_cast<std::int64_t>(std::min(apart_ns, static_cast<std::uint64_t>(kMost))));
}

void BagPairs::takeInfo(const BagMessage& message, StereoSide side) {
  const BagTopic& topic = bag_->topics()[message.topic];
  auto& info = infos_[indexOf(side)];
  const auto format = wireFormatNamed(topic.encoding);
  if (info || !format || sensorMessageNamed(topic.type) != SensorMessage::kCameraInfo) return;
  info = readCameraInfoMessage(
      WireReader(message.data, *format, name_ + ": " + message.place + ", " + printable(topic.name, 80)));
}

std::int64_t BagPairs::withoutPartner(StereoSide side) const {
  return pairing_.unpaired(side) + static_cast<std::int64_t>(pairing_.waiting(side));
}

std::string BagPairs::remark() const {
  std::string text;
  const std::int64_t left = withoutPartner(StereoSide::kLeft), right = withoutPartner(StereoSide::kRight);
  if (left + right > 0)
    text = name_ + ": " + std::to_string(left) + " left and " + std::to_string(right) +
           " right images have no partner within " + std::to_string(kTolerance_ns / 1'000'000) + " ms and are left out";
  if (late_ > 0)
    text += (text.empty() ? name_ + ": " : "; ") + std::to_string(late_) +
            " pairs are left out, as their times do not come after those before";
  return text;
}

}  // namespace motorcade
