#include "core/object_pool.hpp"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace motorcade {
namespace {

/// Fresh memory of some pages, none of them resident.
class FreshPages {
 public:
  explicit FreshPages(std::size_t count)
      : count_(count), begin_(mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {}
  FreshPages(const FreshPages&) = delete;
  FreshPages& operator=(const FreshPages&) = delete;
  ~FreshPages() { munmap(begin_, bytes()); }

  static std::size_t size() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }
  std::byte* begin() const { return static_cast<std::byte*>(begin_); }
  std::vector<bool> resident() const {
    std::vector<unsigned char> pages(count_);
    EXPECT_EQ(mincore(begin_, bytes(), pages.data()), 0);
    std::vector<bool> resident;
    for (const unsigned char page : pages) resident.push_back((page & 1) != 0);
    return resident;
  }

 private:
  std::size_t bytes() const { return count_ * size(); }

  std::size_t count_;
  void* begin_;
};

TEST(PopulatePages, MakesTheWholePagesWithinResident) {
  const FreshPages probe(1);
  populatePages(probe.begin(), FreshPages::size());
  if (!probe.resident().front()) GTEST_SKIP() << "the system cannot populate pages";
  const FreshPages pages(4);
  populatePages(pages.begin() + 1, 3 * FreshPages::size());
  EXPECT_EQ(pages.resident(), (std::vector<bool>{false, true, true, false}));
}

TEST(PopulatePages, LessThanAPageIsLeftAlone) {
  const FreshPages pages(2);
  populatePages(pages.begin() + 1, FreshPages::size());
  EXPECT_EQ(pages.resident(), (std::vector<bool>{false, false}));
}

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
