#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

#include "apps/merge/batch_comparison.hpp"

namespace motorcade {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

/// Mean rank of each magnitude, by counting.
std::vector<double> ranksOf(const std::vector<double>& differences) {
  std::vector<double> ranks;
  for (const double a : differences) {
    double smaller = 0, equal = 0;
    for (const double b : differences) {
      smaller += std::abs(b) < std::abs(a);
      equal += std::abs(b) == std::abs(a);
    }
    ranks.push_back(smaller + (equal + 1) / 2);
  }
  return ranks;
}

/// Share of all 2^n signs that are at least as one-sided, by trying them.
double byAllSigns(const std::vector<double>& differences) {
  const auto ranks = ranksOf(differences);
  const double middle = std::accumulate(ranks.begin(), ranks.end(), 0.0) / 2;
  double observed = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) observed += differences[i] > 0 ? ranks[i] : 0;
  std::size_t extreme = 0;
  for (std::uint32_t signs = 0; signs < (1U << ranks.size()); ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i) sum += (signs >> i & 1U) != 0 ? ranks[i] : 0;
    extreme += std::abs(sum - middle) >= std::abs(observed - middle);
  }
  return static_cast<double>(extreme) / static_cast<double>(1U << ranks.size());
}

/// P(sum of the ranks 1 to n with random signs <= `most`), from the number of ways to each sum.
double tailOfRanks(std::size_t n, std::size_t most) {
  std::vector<double> ways(n * (n + 1) / 2 + 1, 0);
  ways[0] = 1;
  for (std::size_t rank = 1; rank <= n; ++rank)
    for (std::size_t sum = ways.size(); sum-- > rank;) ways[sum] += ways[sum - rank];
  return std::accumulate(ways.begin(), ways.begin() + static_cast<std::ptrdiff_t>(most) + 1, 0.0) /
         std::pow(2.0, static_cast<double>(n));
}

constexpr double kRounding = 1e-12;

TEST(SignedRankTest, AgreesWithAllCombinationsOfSigns) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> with_ties(-4, 4);
  std::uniform_real_distribution<double> without(-1, 2);
  for (std::size_t n = 1; n <= 10; ++n)
    for (int round = 0; round < 20; ++round) {
      std::vector<double> differences;
      while (differences.size() < n)
        if (const double value = round % 2 == 0 ? with_ties(random) : without(random); value != 0)
          differences.push_back(value);
      EXPECT_NEAR(signedRankTest(differences), byAllSigns(differences), kRounding) << n << " differences";
    }
}

TEST(SignedRankTest, AgreesWithPublishedValues) {
  // Darwin's maize, crossed minus self-fertilized in eighths of an inch: p = .04126 in R's manual way, V = 96.
  EXPECT_NEAR(signedRankTest({49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48}), 0.04126, 5e-6);
  // Tables of critical values: of ten differences, a sum of 8 is significant at .05, one of 9 is not.
  EXPECT_NEAR(signedRankTest({1, 2, 3, 4, 5, 6, 7, -8, 9, 10}), 50.0 / 1024, kRounding);
  EXPECT_NEAR(signedRankTest({1, 2, 3, 4, 5, 6, 7, 8, -9, 10}), 66.0 / 1024, kRounding);
}

TEST(SignedRankTest, ZerosSayNothing) {
  EXPECT_EQ(signedRankTest({}), 1);
  EXPECT_EQ(signedRankTest({0, 0, 0}), 1);
  EXPECT_EQ(signedRankTest({0, 3, 1, 0, -2, 5}), signedRankTest({3, 1, -2, 5}));
}

TEST(SignedRankTest, FewerThanSixDifferencesAreNeverSignificant) {
  const std::vector<double> one_sided{1, 2, 3, 4, 5, 6};
  EXPECT_EQ(one_sided.size(), kFewestDifferences);
  EXPECT_LT(signedRankTest(one_sided), 0.05);
  EXPECT_GT(signedRankTest({1, 2, 3, 4, 5}), 0.05);
}

TEST(SignedRankTest, BeyondTheExactOnesTheNormalDistributionIsClose) {
  const std::size_t n = kMostExact + 1;
  for (const std::size_t smaller : {400U, 650U, 700U, 800U}) {
    std::vector<double> differences;  // the largest ranks that fit make the smaller sum
    std::size_t rest = smaller;
    for (std::size_t rank = n; rank >= 1; --rank) {
      const bool negative = rank <= rest;
      if (negative) rest -= rank;
      differences.push_back(negative ? -static_cast<double>(rank) : static_cast<double>(rank));
    }
    ASSERT_EQ(rest, 0U);
    EXPECT_NEAR(signedRankTest(differences), 2 * tailOfRanks(n, smaller), 3e-3);
  }
}

TEST(HolmCorrection, AgreesWithPublishedValues) {
  // R: p.adjust(c(.01, .02, .03, .04, .05), "holm")
  EXPECT_THAT(holmCorrected({0.05, 0.01, 0.02, 0.03, 0.04}),
              ElementsAre(DoubleNear(0.09, kRounding), DoubleNear(0.05, kRounding), DoubleNear(0.08, kRounding),
                          DoubleNear(0.09, kRounding), DoubleNear(0.09, kRounding)));
  EXPECT_THAT(holmCorrected({0.5, 0.9}), ElementsAre(1, 1));
  EXPECT_TRUE(holmCorrected({}).empty());
}

}  // namespace
}  // namespace motorcade
