#include "io/bag/bag_pairing.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace motorcade {
namespace {

/// Stamps of strangers may be anything: their difference is taken without overflow, and is large then.
std::int64_t apart_ns(const BagImage& a, const BagImage& b) {
  const auto [less, more] = std::minmax(a.stamp_ns(), b.stamp_ns());
  const std::uint64_t apart = static_cast<std::uint64_t>(more) - static_cast<std::uint64_t>(less);
  return static_cast<std::int64_t>(std::min<std::uint64_t>(apart, INT64_MAX));
}

}  // namespace

void BagPairing::Side::drop(std::deque<BagImage>::iterator image) {
  bytes -= image->bytes();
  waiting.erase(image);
  ++dropped;
}

void BagPairing::Side::dropOlderThan(std::int64_t stamp_ns) {
  const auto older = [=](const BagImage& image) { return image.stamp_ns() < stamp_ns; };
  for (auto image = std::ranges::find_if(waiting, older); image != waiting.end();
       image = std::ranges::find_if(waiting, older))
    drop(image);
}

/// The one nearest in time within the tolerance, or the end.
std::deque<BagImage>::iterator BagPairing::partnerOf(const BagImage& image, Side& others) {
  const auto nearest =
      std::ranges::min_element(others.waiting, {}, [&](const BagImage& other) { return apart_ns(image, other); });
  if (nearest == others.waiting.end()) return nearest;
  const std::int64_t apart = apart_ns(image, *nearest);
  if (apart <= kTolerance_ns) return nearest;
  nearest_ns_ = std::min(apart, nearest_ns_.value_or(apart));
  return others.waiting.end();
}

std::optional<BagPair> BagPairing::add(StereoSide side, BagImage image) {
  Side& own = sides_[place(side)];
  Side& others = sides_[1 - place(side)];
  const auto partner = partnerOf(image, others);
  if (partner == others.waiting.end()) {
    own.bytes += image.bytes();
    own.waiting.push_back(std::move(image));
    while (own.waiting.size() > kMostWaiting || (own.bytes > kMostWaiting_bytes && own.waiting.size() > 1))
      own.drop(own.waiting.begin());
    return std::nullopt;
  }
  BagImage other = std::move(*partner);
  others.bytes -= other.bytes();
  others.waiting.erase(partner);
  own.dropOlderThan(image.stamp_ns());
  others.dropOlderThan(other.stamp_ns());
  return side == StereoSide::kLeft ? BagPair{std::move(image), std::move(other)}
                                   : BagPair{std::move(other), std::move(image)};
}

void BagPairing::dropWaiting() {
  for (Side& side : sides_)
    while (!side.waiting.empty()) side.drop(side.waiting.begin());
}

}  // namespace motorcade
