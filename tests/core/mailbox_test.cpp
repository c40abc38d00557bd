#include "core/mailbox.hpp"

#include <optional>
#include <thread>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(Mailbox, GivesTheNewestValueAndHandsBackTheOneItReplaced) {
  Mailbox<int> mailbox;
  EXPECT_EQ(mailbox.tryTake(), std::nullopt);
  EXPECT_EQ(mailbox.put(1), std::nullopt);
  EXPECT_EQ(mailbox.put(2), 1);
  EXPECT_EQ(mailbox.put(3), 2);
  EXPECT_EQ(mailbox.tryTake(), 3);
  EXPECT_EQ(mailbox.tryTake(), std::nullopt);
  EXPECT_EQ(mailbox.put(4), std::nullopt);
  EXPECT_EQ(mailbox.overwritten(), 2);
}

TEST(Mailbox, KeepsTheLastValueWhenItIsClosed) {
  Mailbox<int> mailbox;
  mailbox.put(1);
  mailbox.close();
  EXPECT_EQ(mailbox.take(), 1);
  EXPECT_EQ(mailbox.take(), std::nullopt);
}

TEST(Mailbox, ClosingFreesAConsumerThatWaits) {
  Mailbox<int> mailbox;
  std::optional<int> taken = 5;
  std::jthread consumer([&] { taken = mailbox.take(); });
  mailbox.close();
  consumer.join();
  EXPECT_EQ(taken, std::nullopt);
}

TEST(Mailbox, AccountsForEveryValueBetweenTwoThreads) {
  constexpr int kValues = 200'000;
  Mailbox<int> mailbox;
  std::jthread producer([&] {
    for (int value = 1; value <= kValues; ++value) mailbox.put(value);
    mailbox.close();
  });
  int taken = 0, last = 0;
  while (const auto value = mailbox.take()) {
    ASSERT_GT(*value, last);
    last = *value;
    ++taken;
  }
  producer.join();
  EXPECT_EQ(last, kValues);
  EXPECT_EQ(taken + mailbox.overwritten(), kValues);
}

}  // namespace
}  // namespace motorcade
