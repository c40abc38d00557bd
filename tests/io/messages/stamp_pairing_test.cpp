#include "io/messages/stamp_pairing.hpp"

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace motorcade::test {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kMs = 1'000'000;

struct StampedMessage {
  std::int64_t stamp_ns = 0;
  std::vector<int> pixels{};
};
using Pairing = StampPairing<StampedMessage>;

struct Arrival {
  StereoSide side;
  std::int64_t stamp_ms;
};
constexpr StereoSide kL = StereoSide::kLeft, kR = StereoSide::kRight;

/// The stamps of the pairs, left and right, in milliseconds.
std::vector<std::pair<int, int>> pairsOf(Pairing& pairing, const std::vector<Arrival>& arrivals) {
  std::vector<std::pair<int, int>> pairs;
  for (const Arrival& arrival : arrivals)
    if (const auto pair = pairing.add(arrival.side, {.stamp_ns = arrival.stamp_ms * kMs}))
      pairs.emplace_back(pair->left.stamp_ns / kMs, pair->right.stamp_ns / kMs);
  return pairs;
}

TEST(StampPairing, PairsTheSameMomentWhicheverSideComesFirst) {
  Pairing pairing({});
  EXPECT_THAT(pairsOf(pairing, {{kL, 0}, {kR, 0}, {kR, 100}, {kL, 100}, {kL, 200}, {kL, 300}, {kR, 200}, {kR, 300}}),
              ElementsAre(std::pair(0, 0), std::pair(100, 100), std::pair(200, 200), std::pair(300, 300)));
  EXPECT_EQ(pairing.unpaired(kL) + pairing.unpaired(kR), 0);
}

TEST(StampPairing, TheToleranceIsTheLargestDistanceOfAPair) {
  Pairing pairing({.tolerance_ns = 5 * kMs});
  EXPECT_THAT(pairsOf(pairing, {{kL, 0}, {kR, 6}, {kL, 100}, {kR, 105}, {kR, 200}, {kL, 205}}),
              ElementsAre(std::pair(100, 105), std::pair(205, 200)));
  EXPECT_EQ(pairing.unpaired(kL), 1);
  EXPECT_EQ(pairing.unpaired(kR), 1);
}

TEST(StampPairing, TheNearestOfThoseThatWaitIsTaken) {
  Pairing pairing({.tolerance_ns = 50 * kMs});
  EXPECT_THAT(pairsOf(pairing, {{kL, 0}, {kL, 33}, {kL, 66}, {kR, 40}}), ElementsAre(std::pair(33, 40)));
  EXPECT_EQ(pairing.unpaired(kL), 1) << "that before it";
  EXPECT_EQ(pairing.waiting(kL), 1U) << "that behind it";
}

TEST(StampPairing, ASideOfHalfTheRateIsPairedThroughout) {
  Pairing pairing({});
  std::vector<Arrival> arrivals;
  for (std::int64_t i = 0; i < 100; ++i) {
    arrivals.push_back({kL, 50 * i});
    if (i % 2 == 0) arrivals.push_back({kR, 50 * i});
  }
  EXPECT_EQ(pairsOf(pairing, arrivals).size(), 50U);
  EXPECT_EQ(pairing.unpaired(kL), 49) << "the last one may still be paired";
  EXPECT_EQ(pairing.unpaired(kR), 0);
}

TEST(StampPairing, ASideThatIsMissingFillsNoMemory) {
  Pairing pairing({.most_waiting = 4});
  for (int i = 0; i < 1000; ++i) {
    pairing.add(kR, {.stamp_ns = i * 100 * kMs});
    EXPECT_LE(pairing.waiting(kR), 4U);
  }
  EXPECT_EQ(pairing.unpaired(kR), 996);
  EXPECT_THAT(pairsOf(pairing, {{kL, 99'800}}), ElementsAre(std::pair(99'800, 99'800))) << "the newest are kept";
}

TEST(StampPairing, AClockThatIsSetBackIsFollowedAtOnce) {
  Pairing pairing({.most_waiting = 4});
  EXPECT_THAT(pairsOf(pairing, {{kL, 9000}, {kR, 9000}, {kL, 9100}, {kL, 0}, {kR, 0}, {kL, 100}, {kR, 100}}),
              ElementsAre(std::pair(9000, 9000), std::pair(0, 0), std::pair(100, 100)));
  EXPECT_EQ(pairing.unpaired(kL), 1) << "that of 9100 ms";
  EXPECT_EQ(pairing.waiting(kL), 0U);
}

TEST(StampPairing, StampsAtBothEndsOfTimeAreNoPair) {
  Pairing pairing({});
  pairing.add(kL, {.stamp_ns = std::numeric_limits<std::int64_t>::min()});
  EXPECT_FALSE(pairing.add(kR, {.stamp_ns = std::numeric_limits<std::int64_t>::max()}));
}

TEST(StampPairing, PixelsAreNotCopied) {
  Pairing pairing({});
  std::vector<int> left{1, 2}, right{3, 4};
  const int* const left_pixels = left.data();
  const int* const right_pixels = right.data();
  pairing.add(kR, {.stamp_ns = 7, .pixels = std::move(right)});
  const auto pair = pairing.add(kL, {.stamp_ns = 7, .pixels = std::move(left)});
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.pixels.data(), left_pixels);
  EXPECT_EQ(pair->right.pixels.data(), right_pixels);
}

}  // namespace
}  // namespace motorcade::test
