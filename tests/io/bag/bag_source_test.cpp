#include "io/bag/bag_source.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/io/bag/numbered_bag.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::NumberedBag;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class BagSourceTest : public testing::Test {
 protected:
  std::unique_ptr<BagSource> sourceOf(const std::string& content, const BagSource::Params& params = {}) {
    const auto file = folder_.write("bag.mcap", content);
    return std::make_unique<BagSource>(openBagDrive(file, NumberedBag::kTopics, {}), params);
  }
  /// The gray level that each pair should have.
  static std::vector<int> levelsOf(BagSource& source) {
    std::vector<int> levels;
    while (const auto frame = source.next()) {
      EXPECT_EQ(frame->left.at(0, 0), frame->right.at(319, 159));
      EXPECT_EQ(frame->head.stamp.ns, NumberedBag::stampOf_ns(frame->left.at(0, 0)));
      levels.push_back(frame->left.at(0, 0));
    }
    return levels;
  }

  test::TemporaryFolder folder_;
};

TEST_F(BagSourceTest, PairsComeByTheirStampsWhicheverSideComesFirst) {
  NumberedBag bag;
  bag.left(0).right(0).right(1).left(1).left(2).left(3).right(2).right(3);
  const auto source = sourceOf(bag.whole());
  for (int number = 0; number < 4; ++number) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->head.frame.value, number);
    EXPECT_EQ(frame->head.stamp.ns, NumberedBag::stampOf_ns(number));
    EXPECT_EQ(frame->left.at(5, 5), number);
    EXPECT_EQ(frame->right.at(5, 5), number);
    EXPECT_EQ(frame->due, SteadyTime{});
    EXPECT_EQ(source->stampOf({number}).ns, NumberedBag::stampOf_ns(number));
  }
  EXPECT_FALSE(source->next());
  const SourceEnd end = source->finish();
  EXPECT_EQ(end.remark, "");
  EXPECT_FALSE(end.damaged);
}

TEST_F(BagSourceTest, ImagesWithoutAPartnerAreLeftOutAndTold) {
  NumberedBag bag;
  bag.pairs(0, 2).left(2).pairs(3, 5).right(5).left(6);
  const auto source = sourceOf(bag.whole());
  EXPECT_THAT(levelsOf(*source), ElementsAre(0, 1, 3, 4));
  const SourceEnd end = source->finish();
  EXPECT_THAT(end.remark, HasSubstr("2 left and 1 right images have no partner"));
  EXPECT_FALSE(end.damaged);
}

TEST_F(BagSourceTest, StampsMayDifferByTheTolerance) {
  NumberedBag bag;
  bag.pairs(0, 1).left(1).image("right", 1, NumberedBag::stampOf_ns(1) + 5'000'000);
  bag.image("right", 2, NumberedBag::stampOf_ns(2) - 5'000'001).left(2);
  const auto source = sourceOf(bag.whole());
  EXPECT_THAT(levelsOf(*source), ElementsAre(0, 1));
}

TEST_F(BagSourceTest, ThePartnerIsTheNearest) {
  NumberedBag bag;
  bag.image("right", 9, NumberedBag::stampOf_ns(0) - 4'000'000).right(0).left(0);
  const auto source = sourceOf(bag.whole());
  EXPECT_THAT(levelsOf(*source), ElementsAre(0));
  EXPECT_THAT(source->finish().remark, HasSubstr("0 left and 1 right"));
}

TEST_F(BagSourceTest, PairsThatComeTooLateAreLeftOut) {
  const auto source = sourceOf(NumberedBag().pairs(0, 1).pairs(2, 3).pairs(1, 2).pairs(2, 4).whole());
  EXPECT_THAT(levelsOf(*source), ElementsAre(0, 2, 3));
  EXPECT_THAT(source->finish().remark, HasSubstr("2 pairs are left out"));
}

TEST_F(BagSourceTest, TheImagesThatWaitAreBounded) {
  NumberedBag bag;
  bag.pairs(0, 1);
  for (int number = 1; number < 100; ++number) bag.left(number);
  for (int number = 1; number < 100; ++number) bag.right(number);
  const auto source = sourceOf(bag.whole());
  EXPECT_EQ(levelsOf(*source).size(), 17U);
  EXPECT_THAT(source->finish().remark, HasSubstr("83 left and 83 right"));
}

TEST_F(BagSourceTest, AMessageWithoutATimeHasThatOfItsRecording) {
  NumberedBag bag;
  bag.image("left", 0, 0).image("right", 0, 0).pairs(1, 3);
  EXPECT_THAT(levelsOf(*sourceOf(bag.whole())), ElementsAre(0, 1, 2));
}

TEST_F(BagSourceTest, ADamagedBagGivesThePairsBefore) {
  const NumberedBag bag = NumberedBag().pairs(0, 3);
  const auto source = sourceOf(bag.cut() + "rest");
  EXPECT_THAT(levelsOf(*source), ElementsAre(0, 1, 2));
  const SourceEnd end = source->finish();
  EXPECT_THAT(end.remark,
              AllOf(HasSubstr("byte " + std::to_string(bag.cut().size())), HasSubstr("3 pairs came before")));
  EXPECT_FALSE(end.damaged);
}

TEST_F(BagSourceTest, GivesThePairsOfARangeAlone) {
  const std::string bag = NumberedBag().pairs(0, 6).whole();
  const auto source = sourceOf(bag, {.range = {2, 4}});
  EXPECT_EQ(source->first().value, 2);
  EXPECT_THAT(levelsOf(*source), ElementsAre(2, 3));
  const auto behind = sourceOf(bag, {.range = {8, 9}});
  EXPECT_THAT(levelsOf(*behind), IsEmpty());
  const SourceEnd end = behind->finish();
  EXPECT_TRUE(end.damaged);
  EXPECT_THAT(end.remark, HasSubstr("ends after 6 pairs"));
}

TEST_F(BagSourceTest, UnwantedPairsAreLeftOut) {
  const auto even = [](Timestamp stamp) { return stamp.ns / NumberedBag::kPeriod_ns % 2 == 1; };
  const auto source = sourceOf(NumberedBag().pairs(0, 6).whole(), {.wanted = even});
  EXPECT_THAT(levelsOf(*source), ElementsAre(0, 2, 4));
  EXPECT_EQ(source->stampOf({3}).ns, NumberedBag::stampOf_ns(3));
}

TEST_F(BagSourceTest, AnImageThatCannotBeReadCostsItsFrameAlone) {
  NumberedBag bag;
  std::string damaged = test::rosImage(test::Wire::kCdr, NumberedBag::stampOf_ns(1), Image());
  bag.pairs(0, 1).left(1).message("right", damaged, 0).pairs(2, 3);
  const auto source = sourceOf(bag.whole());
  EXPECT_FALSE(source->next()->left.empty());
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->left.empty());
  EXPECT_THAT(frame->problem, AllOf(HasSubstr("bag.mcap: byte "), HasSubstr("/right/image_raw")));
  EXPECT_TRUE(source->next());
}

TEST_F(BagSourceTest, StopsWithoutTakingAllPairs) {
  const auto source = sourceOf(NumberedBag().pairs(0, 60).whole(), {.ahead = 2});
  EXPECT_TRUE(source->next());
  source->stop();
  const SourceEnd end = source->finish();
  EXPECT_EQ(end.remark, "");
  EXPECT_FALSE(end.damaged);
}

/// Many messages may lie behind the last pair of a long recording.
TEST_F(BagSourceTest, StopsWhileNoPairComes) {
  test::McapText rest;
  for (int i = 0; i < 1000; ++i) rest.message(1, 0, "no image");
  BagPairs pairs(folder_.write("bag.mcap", NumberedBag().pairs(0, 1).cut() + rest.text()),
                 parseImageTopics(NumberedBag::kTopics), BagPairs::Infos::kLeaveOut);
  EXPECT_TRUE(pairs.next());
  pairs.bag().stop();
  EXPECT_FALSE(pairs.next()) << "what follows would be an error";
}

}  // namespace
}  // namespace motorcade
