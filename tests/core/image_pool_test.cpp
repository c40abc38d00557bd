#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/image.hpp"

namespace motorcade {
namespace {

TEST(ImagePool, RowsBeginAtMultiplesOf32Bytes) {
  ImagePool pool;
  for (const int width : {1, 31, 32, 33, 1242}) {
    const Image image = pool.acquire(width, 3);
    EXPECT_EQ(image.stride() % 32, 0);
    EXPECT_GE(image.stride(), width);
    for (int y = 0; y < 3; ++y) EXPECT_EQ(reinterpret_cast<std::uintptr_t>(image.row(y)) % 32, 0U);
  }
}

TEST(ImagePool, MakesNoMoreBuffersThanAreInUseAtOnce) {
  ImagePool pool;
  for (int i = 0; i < 100; ++i) {
    const Image large = pool.acquire(64, 32), small = pool.acquire(32, 16), other = pool.acquire(64, 32);
    const Image copy = large;  // NOLINT(performance-unnecessary-copy-initialization): it shares the buffer
  }
  EXPECT_EQ(pool.buffersMade(), 3U);
}

TEST(ImagePool, AnImageStaysWholeUntilItsLastCopyIsGone) {
  ImagePool pool;
  Image first = pool.acquire(32, 4);
  const Image copy = first;
  first.mutableRow(2)[5] = 77;
  first = Image();
  Image second = pool.acquire(32, 4);
  second.mutableRow(2)[5] = 11;
  EXPECT_EQ(copy.at(5, 2), 77);
}

TEST(ImagePool, ImagesOutliveTheirPool) {
  Image image;
  {
    ImagePool pool;
    image = pool.acquire(40, 10);
  }
  image.mutableRow(9)[39] = 5;
  EXPECT_EQ(image.at(39, 9), 5);
}

TEST(ImagePool, ServesMoreImagesAndSizesThanItKeeps) {
  ImagePool pool;
  std::vector<Image> images;
  for (int size = 1; size <= 40; ++size)
    for (int i = 0; i < 100; ++i) images.push_back(pool.acquire(32, size));
  for (std::size_t i = 0; i < images.size(); ++i) images[i].mutableRow(0)[0] = static_cast<std::uint8_t>(i % 251);
  for (std::size_t i = 0; i < images.size(); ++i) ASSERT_EQ(images[i].at(0, 0), i % 251);
}

/// Each thread writes its own number all over its images, and hands every other one to the next thread, which releases
/// it.
TEST(ImagePool, NoTwoThreadsEverHoldTheSameBuffer) {
  constexpr int kThreads = 4, kRounds = 2000;
  ImagePool pool;
  std::atomic<int> spoilt{0};
  std::vector<std::atomic<Image*>> handed(kThreads);
  const auto work = [&](int self) {
    for (int round = 0; round < kRounds; ++round) {
      auto image = std::make_unique<Image>(pool.acquire(64, 2 + round % 3));
      const auto mark = static_cast<std::uint8_t>(self * 50 + round % 50);
      for (int x = 0; x < 64; ++x) image->mutableRow(0)[x] = mark;
      for (int x = 0; x < 64; ++x)
        if (image->at(x, 0) != mark) ++spoilt;
      if (round % 2 == 0) continue;
      const std::unique_ptr<Image> before(handed[(self + 1) % kThreads].exchange(image.release()));
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int self = 0; self < kThreads; ++self) threads.emplace_back(work, self);
  }
  for (auto& left : handed) delete left.load();
  EXPECT_EQ(spoilt, 0);
  constexpr std::size_t kMissed = kRounds / 10;  // a search may miss a buffer that is put back meanwhile
  EXPECT_LT(pool.buffersMade(), kMissed);
}

}  // namespace
}  // namespace motorcade
