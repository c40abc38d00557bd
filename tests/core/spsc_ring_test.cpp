#include "core/spsc_ring.hpp"

#include <memory>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(SpscRing, RoundsItsCapacityUpAndRefusesWhatDoesNotFit) {
  SpscRing<int> ring(3);
  ASSERT_EQ(ring.capacity(), 4u);
  for (int value = 0; value < 4; ++value) EXPECT_TRUE(ring.tryPush(value));
  int refused = 4;
  EXPECT_FALSE(ring.tryPush(refused));
  EXPECT_EQ(refused, 4);
  EXPECT_EQ(ring.tryPop(), 0);
  EXPECT_TRUE(ring.tryPush(refused));
  EXPECT_EQ(ring.highWater(), 4u);
}

TEST(SpscRing, KeepsTheOrderOverManyWraps) {
  SpscRing<int> ring(2);
  for (int value = 0; value < 100; ++value) {
    int pushed = value;
    ASSERT_TRUE(ring.tryPush(pushed));
    ASSERT_EQ(ring.tryPop(), value);
  }
  EXPECT_EQ(ring.tryPop(), std::nullopt);
  EXPECT_EQ(ring.highWater(), 1u);
}

TEST(SpscRing, LetsGoOfWhatWasPopped) {
  SpscRing<std::shared_ptr<int>> ring(2);
  auto value = std::make_shared<int>(7);
  ring.push(value);
  EXPECT_EQ(*ring.pop(), value);
  EXPECT_EQ(value.use_count(), 1);
}

TEST(SpscRing, CarriesEveryValueInOrderBetweenTwoThreads) {
  constexpr int kValues = 200'000;
  SpscRing<int> ring(8);
  std::jthread producer([&] {
    for (int value = 0; value < kValues; ++value) ASSERT_TRUE(ring.push(value));
    ring.close();
  });
  for (int value = 0; value < kValues; ++value) ASSERT_EQ(ring.pop(), value);
  EXPECT_EQ(ring.pop(), std::nullopt);
  producer.join();
  EXPECT_LE(ring.highWater(), ring.capacity());
}

TEST(SpscRing, ClosingFreesAProducerThatWaitsAndKeepsWhatWasPushed) {
  SpscRing<int> ring(1);
  ASSERT_TRUE(ring.push(1));
  bool pushed = true;
  std::jthread producer([&] { pushed = ring.push(2); });
  ring.close();
  producer.join();
  EXPECT_FALSE(pushed);
  EXPECT_EQ(ring.pop(), 1);
  EXPECT_EQ(ring.pop(), std::nullopt);
}

TEST(SpscRing, ClosingFreesAConsumerThatWaits) {
  SpscRing<int> ring(1);
  std::optional<int> popped = 5;
  std::jthread consumer([&] { popped = ring.pop(); });
  ring.close();
  consumer.join();
  EXPECT_EQ(popped, std::nullopt);
}

}  // namespace
}  // namespace motorcade
