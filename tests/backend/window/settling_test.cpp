#include "backend/window/settling.hpp"

#include <gmock/gmock.h>

namespace motorcade {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Record {
  FrameHead head;
};

Record recordAt(std::int64_t stamp_ns) {
  Record record;
  record.head.stamp.ns = stamp_ns;
  return record;
}

TEST(Settling, EachFrameSettlesOnceWhenItIsOldEnough) {
  Settling settling(0.25);
  std::map<FrameId, Record> window;
  std::vector<FrameId> settled;
  for (std::int64_t i = 0; i < 10; ++i) {
    window[{i}] = recordAt(i * 100'000'000);
    for (const FrameId frame : settling(window)) {
      EXPECT_EQ(frame.value, i - 3);
      settled.push_back(frame);
    }
  }
  EXPECT_EQ(settled.size(), 7u);
}

TEST(Settling, GapsOfTimeSettleAllThatCameBefore) {
  Settling settling(10);
  std::map<FrameId, Record> window{{{3}, recordAt(0)}, {{5}, recordAt(1'000'000'000)}};
  EXPECT_THAT(settling(window), IsEmpty());
  window[{6}] = recordAt(3'600'000'000'000);
  EXPECT_THAT(settling(window), ElementsAre(FrameId{3}, FrameId{5}));
  EXPECT_THAT(settling(window), IsEmpty());
}

TEST(Settling, FramesThatLeftTheWindowEarlierDoNot) {
  Settling settling(0.15);
  std::map<FrameId, Record> window;
  for (std::int64_t i = 0; i < 5; ++i) {
    window[{i}] = recordAt(i * 100'000'000);
    if (window.size() > 1) window.erase(window.begin());
    EXPECT_THAT(settling(window), IsEmpty());
  }
}

TEST(Settling, WithoutALagTheNewestFrameSettlesAtOnce) {
  Settling settling(0);
  EXPECT_THAT(settling(std::map<FrameId, Record>{{{0}, recordAt(0)}}), ElementsAre(FrameId{0}));
}

}  // namespace
}  // namespace motorcade
