#include "backend/block_pool.hpp"

#include <algorithm>
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

std::size_t below(test::Noise& noise, std::size_t n) { return static_cast<std::size_t>(noise.uniform(0, static_cast<double>(n) - 1e-9)); }

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
    if (!out.empty() && below(noise, 5) < 2) {
      std::swap(out[below(noise, out.size())], out.back());
      pool.give(out.back().data, out.back().doubles);
      out.pop_back();
      continue;
    }
    const std::size_t doubles = below(noise, 20) == 0 ? below(noise, 100000) : below(noise, 300);
    out.push_back({pool.take(doubles), doubles});
    std::fill_n(out.back().data, doubles, 1.0);  // the address sanitizer watches the chunks' ends
  }
  std::ranges::sort(out, {}, &Block::data);
  for (std::size_t i = 1; i < out.size(); ++i) EXPECT_LE(out[i - 1].data + out[i - 1].doubles, out[i].data);
}

TEST(BlockPool, GivesTheSameMemoryOutAgain) {
  BlockPool pool;
  test::Noise noise(2);
  std::vector<Block> out;
  for (int i = 0; i < 500; ++i) {
    const std::size_t doubles = below(noise, 2000);
    out.push_back({pool.take(doubles), doubles});
  }
  const std::size_t held = pool.heldBytes(), used = pool.usedBytes();
  for (int round = 0; round < 20; ++round) {
    for (const Block& block : out) pool.give(block.data, block.doubles);
    std::ranges::reverse(out);
    for (Block& block : out) block.data = pool.take(block.doubles);
    EXPECT_EQ(pool.heldBytes(), held);
    EXPECT_EQ(pool.usedBytes(), used);
  }
  for (const Block& block : out) pool.give(block.data, block.doubles);
  EXPECT_EQ(pool.usedBytes(), 0U);
  EXPECT_EQ(pool.heldBytes(), held);
}

TEST(BlockPool, ABlockServesEveryDemandOfItsSizeClass) {
  BlockPool pool;
  double* block = pool.take(65);
  pool.give(block, 65);
  EXPECT_EQ(pool.take(72), block);  // as many cache lines
}

TEST(BlockPool, WastesAtMostAFifthOfALargeBlock) {
  for (std::size_t doubles = 64; doubles < 100000; doubles += 1 + doubles / 50) {
    BlockPool pool;
    pool.take(doubles);
    EXPECT_GE(pool.usedBytes(), doubles * sizeof(double));
    // The 8 doubles are the cache line that the last of them begin.
    EXPECT_LE(pool.usedBytes(), (doubles + 8) * sizeof(double) * 5 / 4) << doubles;
  }
}

TEST(BlockPool, TakesNothingBackForNothing) {
  BlockPool pool;
  pool.take(10);
  const std::size_t used = pool.usedBytes();
  pool.give(nullptr, 10);
  EXPECT_EQ(pool.usedBytes(), used);
  EXPECT_NE(pool.take(10), nullptr);
}

}  // namespace
}  // namespace motorcade
