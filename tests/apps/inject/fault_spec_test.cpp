#include "apps/inject/fault_spec.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

std::string messageOf(const std::string& text) {
  try {
    parseFaultSpec(text);
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST(FaultSpec, IsReadInAllItsParts) {
  const FaultSpec spec = parseFaultSpec("black@20:23,noise=12.5/right@5::3~0.1,seed=7,drop@4,one_eyed");
  EXPECT_EQ(spec.seed, 7u);
  ASSERT_EQ(spec.faults.size(), 4u);
  EXPECT_EQ(spec.faults[0].kind, FaultKind::kBlack);
  EXPECT_EQ(spec.faults[0].frames.begin, 20u);
  EXPECT_EQ(spec.faults[0].frames.end, 23u);
  EXPECT_EQ(spec.faults[1].value, 12.5);
  EXPECT_EQ(spec.faults[1].side, FaultSide::kRight);
  EXPECT_EQ(spec.faults[1].frames.begin, 5u);
  EXPECT_EQ(spec.faults[1].step, 3u);
  EXPECT_EQ(spec.faults[1].share, 0.1);
  EXPECT_EQ(spec.faults[2].frames.size(), 1u);
  EXPECT_EQ(spec.faults[3].side, FaultSide::kRight);
  EXPECT_TRUE(parseFaultSpec("").faults.empty());
}

TEST(FaultSpec, WhatItCannotReadIsNamedWithTheMend) {
  EXPECT_THAT(messageOf("blak@3"), HasSubstr("blak is no fault; these are:\n  drop"));
  EXPECT_THAT(messageOf("drop@1,noise=loud"), HasSubstr("noise=loud: loud is no number from 0 to 255"));
  EXPECT_THAT(messageOf("black=3"), HasSubstr("takes no value"));
  EXPECT_THAT(messageOf("black/top"), HasSubstr("write /left or /right"));
  EXPECT_THAT(messageOf("drop/left"), HasSubstr("is of the pair"));
  EXPECT_THAT(messageOf("drop@3:1:0"), HasSubstr("0 is no number from 1"));
  EXPECT_THAT(messageOf("drop~2"), HasSubstr("2 is no number from 0 to 1"));
}

TEST(FaultSpec, StrikesTheFramesThatItNamesAndTheSameShareForTheSameSeed) {
  const FaultSpec spec = parseFaultSpec("drop@10:20:4,drop~0.3");
  for (int frame = 0; frame < 30; ++frame)
    EXPECT_EQ(strikes(spec.faults[0], 0, {frame}, 1), frame == 10 || frame == 14 || frame == 18) << frame;
  int struck = 0, differently = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    const bool once = strikes(spec.faults[1], 1, {frame}, 1);
    struck += once;
    EXPECT_EQ(once, strikes(spec.faults[1], 1, {frame}, 1));
    differently += once != strikes(spec.faults[1], 1, {frame}, 2);
  }
  EXPECT_NEAR(struck, 300, 60);
  EXPECT_GT(differently, 200);
}

}  // namespace
}  // namespace motorcade
