#include "backend/elimination/elimination_pattern.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using Group = EliminationPattern::Group;

struct Problem {
  int count = 0, boundary = 0;
  std::vector<std::vector<int>> terms;
  std::vector<int> scalars;
};

Problem randomProblem(test::Noise& noise) {
  Problem problem{.count = 1 + noise.below(25), .boundary = noise.below(4), .terms = {}, .scalars = {}};
  const int total = problem.count + problem.boundary;
  for (int t = noise.below(40); t >= 0; --t) {
    std::set<int> term{noise.below(problem.count)};
    // Mostly near each other, as in trajectories.
    for (int i = noise.below(3); i > 0; --i)
      term.insert(std::min(total - 1, *term.begin() + noise.below(noise.below(4) == 0 ? total : 4)));
    problem.terms.emplace_back(term.begin(), term.end());
    if (noise.below(2) == 0) std::ranges::reverse(problem.terms.back());  // any order will do
  }
  for (int i = 0; i < total; ++i) problem.scalars.push_back(1 + noise.below(6));
  return problem;
}

EliminationPattern analyzed(const Problem& problem) {
  EliminationPattern pattern;
  pattern.begin(problem.count, problem.boundary);
  for (const auto& term : problem.terms) pattern.addTerm(term);
  pattern.analyze(problem.scalars);
  return pattern;
}

/// Positions that each position meets when it is eliminated, by elimination of the graph of the terms.
std::vector<std::set<int>> eliminated(const Problem& problem) {
  std::vector<std::set<int>> later(problem.count + problem.boundary);
  const auto join = [&](const auto& clique) {
    for (const int a : clique)
      for (const int b : clique)
        if (b > a) later[a].insert(b);
  };
  for (const auto& term : problem.terms) join(term);
  for (int j = 0; j < problem.count; ++j) join(std::set(later[j]));
  later.resize(problem.count);
  return later;
}

TEST(EliminationPattern, GroupsHoldWhatABruteForceEliminationMeets) {
  test::Noise noise(1);
  for (int i = 0; i < 500; ++i) {
    const Problem problem = randomProblem(noise);
    const auto pattern = analyzed(problem);
    const auto expected = eliminated(problem);
    for (int j = 0; j < problem.count; ++j) {
      const auto positions = pattern.positions(pattern.groups()[pattern.groupOf(j)]);
      ASSERT_TRUE(std::ranges::includes(positions, expected[j])) << "problem " << i << ", position " << j;
    }
  }
}

TEST(EliminationPattern, EachPositionIsFrontalOnce) {
  test::Noise noise(2);
  for (int i = 0; i < 200; ++i) {
    const Problem problem = randomProblem(noise);
    const auto pattern = analyzed(problem);
    std::vector<int> frontals;
    for (std::size_t g = 0; g < pattern.groups().size(); ++g) {
      const Group& group = pattern.groups()[g];
      const auto positions = pattern.positions(group);
      ASSERT_GT(group.frontals, 0);
      ASSERT_THAT(positions, testing::WhenSorted(testing::ElementsAreArray(positions)));
      for (const int p : positions.first(group.frontals)) {
        frontals.push_back(p);
        ASSERT_EQ(pattern.groupOf(p), static_cast<int>(g));
      }
    }
    std::ranges::sort(frontals);
    std::vector<int> all(problem.count);
    std::iota(all.begin(), all.end(), 0);
    ASSERT_EQ(frontals, all);
  }
}

TEST(EliminationPattern, AParentComesFirstAndHoldsItsChildrensSeparators) {
  test::Noise noise(3);
  for (int i = 0; i < 200; ++i) {
    const Problem problem = randomProblem(noise);
    const auto pattern = analyzed(problem);
    for (std::size_t g = 0; g < pattern.groups().size(); ++g) {
      const Group& group = pattern.groups()[g];
      const auto separator = pattern.positions(group).subspan(group.frontals);
      if (group.parent < 0) {
        for (const int p : separator) ASSERT_GE(p, problem.count);
        continue;
      }
      ASSERT_LT(group.parent, static_cast<int>(g));
      ASSERT_TRUE(std::ranges::includes(pattern.positions(pattern.groups()[group.parent]), separator));
    }
  }
}

TEST(EliminationPattern, ATermBelongsToTheGroupOfItsFirstPosition) {
  test::Noise noise(4);
  for (int i = 0; i < 200; ++i) {
    const Problem problem = randomProblem(noise);
    const auto pattern = analyzed(problem);
    for (std::size_t t = 0; t < problem.terms.size(); ++t) {
      const auto& term = problem.terms[t];
      const Group& group = pattern.groups()[pattern.groupOfTerm(static_cast<int>(t))];
      ASSERT_THAT(pattern.positions(group).first(group.frontals), testing::Contains(*std::ranges::min_element(term)));
      ASSERT_THAT(pattern.positions(group), testing::IsSupersetOf(term));
    }
  }
}

Problem chainOfPoses(int count) {
  Problem chain{.count = count, .boundary = 0, .terms = {}, .scalars = std::vector<int>(count, 6)};
  for (int i = 1; i < count; ++i) chain.terms.push_back({i - 1, i});
  return chain;
}

/// Joining cliques must not turn a sparse problem into a dense one.
TEST(EliminationPattern, AChainOfPosesStaysAChain) {
  const auto pattern = analyzed(chainOfPoses(200));
  for (const Group& group : pattern.groups()) EXPECT_LE(group.size, 4);
}

TEST(EliminationPattern, PosesJoinByThreesWhateverZerosThatAdds) {
  const auto pattern = analyzed(chainOfPoses(200));
  EXPECT_EQ(std::ranges::count(pattern.groups(), 3, &Group::frontals), 66);
  EXPECT_EQ(pattern.groups().size(), 67U) << "and two are left over";
}

TEST(EliminationPattern, ColumnsOfOneCliqueShareAGroup) {
  Problem clique{.count = 8, .boundary = 0, .terms = {{0, 1, 2, 3, 4, 5, 6, 7}}, .scalars = std::vector<int>(8, 6)};
  EXPECT_EQ(analyzed(clique).groups().size(), 1U);
}

}  // namespace
}  // namespace motorcade
