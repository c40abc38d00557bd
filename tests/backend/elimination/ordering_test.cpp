#include "backend/elimination/ordering.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using Rows = std::vector<std::vector<int>>;

Rows randomRows(test::Noise& noise, int columns, int rows) {
  Rows result;
  for (int r = 0; r < rows; ++r) {
    std::set<int> entries;
    for (int i = 0; i < 2 + noise.below(2); ++i) entries.insert(noise.below(columns));
    result.emplace_back(entries.begin(), entries.end());
  }
  return result;
}

std::vector<int> ordered(Ordering& ordering, int columns, const Rows& rows, const std::vector<int>& group) {
  ordering.begin(columns);
  for (const auto& row : rows) ordering.addRow(row);
  const auto order = ordering.order(group);
  return {order.begin(), order.end()};
}

/// Entries of R off the diagonal when the columns are eliminated in this order.
int entriesOfR(int columns, const Rows& rows, const std::vector<int>& order) {
  std::vector<std::set<int>> neighbors(static_cast<std::size_t>(columns));
  const auto join = [&](const auto& clique) {
    for (const int a : clique)
      for (const int b : clique)
        if (a != b) neighbors[a].insert(b);
  };
  for (const auto& row : rows) join(row);
  int entries = 0;
  for (const int column : order) {
    const std::set<int> left = neighbors[column];
    entries += static_cast<int>(left.size());
    join(left);
    for (const int other : left) neighbors[other].erase(column);
  }
  return entries;
}

TEST(Ordering, IsAPermutation) {
  test::Noise noise(1);
  Ordering ordering;
  for (int i = 0; i < 200; ++i) {
    const int columns = noise.below(40);
    const auto rows = columns == 0 ? Rows{} : randomRows(noise, columns, noise.below(80));
    auto order = ordered(ordering, columns, rows, std::vector<int>(static_cast<std::size_t>(columns), 0));
    std::ranges::sort(order);
    std::vector<int> all(static_cast<std::size_t>(columns));
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
  }
}

TEST(Ordering, PutsHigherGroupsLater) {
  test::Noise noise(2);
  Ordering ordering;
  for (int i = 0; i < 200; ++i) {
    const int columns = 1 + noise.below(40);
    std::vector<int> group(static_cast<std::size_t>(columns));
    for (int& g : group) g = noise.below(std::min(3, columns));
    auto groups = ordered(ordering, columns, randomRows(noise, columns, 60), group);
    for (int& column : groups) column = group[column];
    EXPECT_THAT(groups, testing::WhenSorted(testing::ElementsAreArray(groups)));
  }
}

TEST(Ordering, FillsLittleMoreThanTheBestOrder) {
  test::Noise noise(3);
  Ordering ordering;
  int total = 0, least = 0;
  for (int i = 0; i < 60; ++i) {
    const int columns = 4 + noise.below(4);
    const auto rows = randomRows(noise, columns, columns + noise.below(4));
    total += entriesOfR(columns, rows,
                        ordered(ordering, columns, rows, std::vector<int>(static_cast<std::size_t>(columns), 0)));
    std::vector<int> order(static_cast<std::size_t>(columns));
    std::iota(order.begin(), order.end(), 0);
    int best = std::numeric_limits<int>::max();
    do best = std::min(best, entriesOfR(columns, rows, order));
    while (std::ranges::next_permutation(order).found);
    least += best;
  }
  EXPECT_LE(total, least * 1.1);  // minimum degree is a greedy choice; in any order it would be about 1.3
}

TEST(Ordering, EliminatesAChainWithoutFill) {
  constexpr int kColumns = 100;
  Rows chain;
  std::vector<int> place(kColumns);
  std::iota(place.begin(), place.end(), 0);
  test::Noise noise(4);
  for (std::size_t i = kColumns; --i > 0;) std::swap(place[i], place[noise.below(i + 1)]);
  for (std::size_t i = 1; i < kColumns; ++i) chain.push_back({place[i - 1], place[i]});
  Ordering ordering;
  const auto order = ordered(ordering, kColumns, chain, std::vector<int>(kColumns, 0));
  EXPECT_EQ(entriesOfR(kColumns, chain, order), kColumns - 1);
}

}  // namespace
}  // namespace motorcade
