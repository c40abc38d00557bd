#include "backend/graph/block_pool.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

struct Block {
  double* data;
  std::size_t doubles;
};

TEST(BlockPool, BlocksBeginOnACacheLine) {
  BlockPool pool;
  for (const std::size_t doubles : {0, 1, 7, 8, 9, 63, 64, 65, 80, 81, 1000, 65536, 65537, 200000})
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(pool.take(doubles)) % 64, 0U) << doubles;
}

TEST(BlockPool, BlocksThatAreOutNeverOverlap) {
  BlockPool pool;
  test::Noise noise(1);
  std::vector<Block> out;
  for (int i = 0; i < 3000; ++i) {
    if (!out.empty() && noise.below(5) < 2) {
      std::swap(out[noise.below(out.size())], out.back());
      pool.give(out.back().data);
      out.pop_back();
      continue;
    }
    const std::size_t doubles = noise.below(20) == 0 ? noise.below<std::size_t>(100000) : noise.below<std::size_t>(300);
    out.push_back({pool.take(doubles), doubles});
    std::fill_n(out.back().data, doubles, 1.0);  // the address sanitizer watches the chunks' ends
  }
  std::ranges::sort(out, {}, &Block::data);
  for (std::size_t i = 1; i < out.size(); ++i) EXPECT_LE(out[i - 1].data + out[i - 1].doubles, out[i].data);
}

TEST(BlockPool, ABlockThatGrowsLittleByLittleSeldomMoves) {
  BlockPool pool;
  constexpr std::size_t kFirst = 1000, kLast = 100'000, kStep = 100;
  double* block = pool.takeToGrow(kFirst);
  int moves = 0;
  for (std::size_t doubles = kFirst; doubles <= kLast; doubles += kStep) {
    if (!BlockPool::fits(block, doubles)) {
      pool.give(block);
      block = pool.takeToGrow(doubles);
      ++moves;
    }
    std::fill_n(block, doubles, 1.0);  // the address sanitizer watches the chunks' ends
  }
  EXPECT_LE(moves, 40) << "an eighth more each time";
  EXPECT_LE(pool.usedBytes(), (kLast + kLast / 8 + 16) * sizeof(double));
}

TEST(BlockPool, GivesTheSameMemoryOutAgain) {
  BlockPool pool;
  test::Noise noise(2);
  std::vector<Block> out;
  for (int i = 0; i < 500; ++i) {
    const std::size_t doubles = noise.below<std::size_t>(2000);
    out.push_back({pool.take(doubles), doubles});
  }
  const std::size_t held = pool.heldBytes(), used = pool.usedBytes();
  for (int round = 0; round < 20; ++round) {
    for (const Block& block : out) pool.give(block.data);
    EXPECT_EQ(pool.usedBytes(), 0U);
    for (Block& block : out) block.data = pool.take(block.doubles);
    EXPECT_EQ(pool.heldBytes(), held);
    EXPECT_EQ(pool.usedBytes(), used);
  }
}

TEST(BlockPool, NeighborsThatComeBackAreOneBlockAgain) {
  for (const auto& order : {std::array{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    BlockPool pool;
    std::array<double*, 3> blocks{};
    for (double*& block : blocks) block = pool.take(100);
    const double* end = pool.take(100);
    for (const int i : order) pool.give(blocks[i]);
    EXPECT_EQ(pool.take(310), blocks[0]);
    EXPECT_GT(pool.take(1), end);  // nothing is left below
  }
}

/// Imitates a solver whose matrices grow and shrink: each size has its largest demand at another time.
TEST(BlockPool, HoldsLittleMoreThanTheLargestDemand) {
  BlockPool pool;
  test::Noise noise(3);
  std::vector<Block> out;
  std::size_t demand_bytes = 0;
  constexpr std::size_t kLargest_bytes = 20'000'000;
  for (int i = 0; i < 60000; ++i) {
    const std::size_t usual = 100 + static_cast<std::size_t>(i / 1000 % 10) * 500,
                      doubles = usual / 2 + noise.below(usual);
    if (demand_bytes + doubles * sizeof(double) > kLargest_bytes) {
      std::swap(out[noise.below(out.size())], out.back());
      pool.give(out.back().data);
      demand_bytes -= out.back().doubles * sizeof(double);
      out.pop_back();
    } else {
      out.push_back({pool.take(doubles), doubles});
      demand_bytes += doubles * sizeof(double);
    }
  }
  EXPECT_LT(pool.heldBytes(),
            kLargest_bytes / 10 * 16);  // measured: 1.31 times; 2.46 where blocks keep the sizes that they were cut to
}

TEST(BlockPool, WastesLessThanTwoCacheLines) {
  for (std::size_t doubles = 0; doubles < 100000; doubles += 1 + doubles / 50) {
    BlockPool pool;
    pool.take(doubles);
    EXPECT_GE(pool.usedBytes(), doubles * sizeof(double));
    EXPECT_LT(pool.usedBytes(), doubles * sizeof(double) + 128) << doubles;
  }
}

TEST(BlockPool, TakesNothingBackForNothing) {
  BlockPool pool;
  pool.take(10);
  const std::size_t used = pool.usedBytes();
  pool.give(nullptr);
  EXPECT_EQ(pool.usedBytes(), used);
  EXPECT_NE(pool.take(10), nullptr);
}

}  // namespace
}  // namespace motorcade
