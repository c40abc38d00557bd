#include "core/object_pool.hpp"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

struct Numbers {
  std::vector<int> values;
};

TEST(ObjectPool, AnObjectComesBackWithWhatItHolds) {
  ObjectPool<Numbers> pool;
  auto first = pool.acquire();
  first->values.assign(1000, 7);
  const int* memory = first->values.data();
  first.reset();
  EXPECT_EQ(pool.acquire()->values.data(), memory);
}

TEST(ObjectPool, AnObjectInUseIsNotHandedOutAgain) {
  ObjectPool<Numbers> pool;
  const auto first = pool.acquire();
  const auto copy = first;  // NOLINT(performance-unnecessary-copy-initialization): it keeps the object in use
  const auto second = pool.acquire();
  EXPECT_NE(first, second);
  EXPECT_EQ(copy, first);
}

TEST(ObjectPool, ObjectsOutliveTheirPool) {
  std::shared_ptr<Numbers> object;
  {
    ObjectPool<Numbers> pool;
    object = pool.acquire();
  }
  object->values.push_back(3);
  EXPECT_EQ(object->values.front(), 3);
}

TEST(ObjectPool, ServesMoreThanItKeeps) {
  ObjectPool<Numbers> pool;
  for (int round = 0; round < 2; ++round) {
    std::vector<std::shared_ptr<Numbers>> held;
    for (int i = 0; i < 200; ++i) held.push_back(pool.acquire());
    for (int i = 0; i < 200; ++i) held[i]->values.assign(1, i);
    for (int i = 0; i < 200; ++i) ASSERT_EQ(held[i]->values.front(), i);
  }
}

TEST(ObjectPool, NoTwoThreadsEverHoldTheSameObject) {
  constexpr int kThreads = 4, kRounds = 2000;
  ObjectPool<Numbers> pool;
  std::atomic<int> spoilt{0};
  {
    std::vector<std::jthread> threads;
    for (int self = 0; self < kThreads; ++self)
      threads.emplace_back([&, self] {
        for (int round = 0; round < kRounds; ++round) {
          const auto object = pool.acquire();
          object->values.assign(32, self * kRounds + round);
          spoilt += static_cast<int>(32 - std::ranges::count(object->values, self * kRounds + round));
        }
      });
  }
  EXPECT_EQ(spoilt, 0);
}

}  // namespace
}  // namespace motorcade
