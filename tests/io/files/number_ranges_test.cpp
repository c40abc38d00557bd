#include "io/files/number_ranges.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

std::string textOf(const std::vector<std::int64_t>& numbers) { return rangesOf(numbers); }

TEST(NumberRanges, JoinWhatFollowsInARow) {
  EXPECT_EQ(textOf({}), "");
  EXPECT_EQ(textOf({7}), "7");
  EXPECT_EQ(textOf({3, 4, 5, 6, 7, 9, 11, 12}), "3-7, 9, 11-12");
}

}  // namespace
}  // namespace motorcade
