#include "io/inputs/pair_source.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "tests/io/three_pairs.hpp"

namespace motorcade {
namespace {

TEST(ForwardingSource, IsLikeTheSourceBehindIt) {
  test::ThreePairs pairs;
  ForwardingSource same(std::make_unique<test::ThreePairs>());
  EXPECT_EQ(same.first(), pairs.first());
  EXPECT_EQ(same.stampOf({2}), pairs.stampOf({2}));
  EXPECT_EQ(same.shareOutside(), pairs.shareOutside());
  EXPECT_EQ(same.highWater(), pairs.highWater());
  EXPECT_EQ(same.capacity(), pairs.capacity());
  const auto frame = same.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->head.stamp, pairs.next()->head.stamp);
  same.stop();
  EXPECT_FALSE(same.next());
  EXPECT_EQ(same.finish().remark, pairs.finish().remark);
}

}  // namespace
}  // namespace motorcade
