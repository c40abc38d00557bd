#include "io/sequence/pairing.hpp"

#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/sequence/image_names.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A name made of a number.
using NameOf = std::function<std::string(int)>;

std::string padded(int number, std::size_t width) {
  const std::string digits = std::to_string(number);
  return std::string(width > digits.size() ? width - digits.size() : 0, '0') + digits;
}

/// Images are files without content: names alone count.
class Pairing : public testing::Test {
 protected:
  void write(const std::string& side, const std::string& name) { folder_.write(side + "/" + name, ""); }
  void writeAll(const std::string& side, int count, const NameOf& name_of, const std::vector<int>& missing = {}) {
    for (int i = 0; i < count; ++i)
      if (std::ranges::find(missing, i) == missing.end()) write(side, name_of(i));
  }
  PairedImages pair() {
    return pairImages(namedImages(imagesIn(folder_ / "left")), namedImages(imagesIn(folder_ / "right")));
  }
  Sequence sequence() {
    Sequence sequence;
    setPairs(sequence, pair());
    return sequence;
  }
  std::string error() {
    return messageOf<InputError>([&] { pair(); });
  }

  test::TemporaryFolder folder_;
};

std::string namesOf(const FramePaths& frame) {
  return frame.left.filename().string() + (frame.left_missing ? "?" : "") + " " + frame.right.filename().string() +
         (frame.right_missing ? "?" : "");
}

NameOf name(const std::string& before, std::size_t width, const std::string& after = ".png") {
  return [=](int i) { return before + padded(i, width) + after; };
}

TEST_F(Pairing, OneImageMissingOnEachSideCostsTwoFramesAndNoOther) {
  writeAll("left", 12, name("left", 4), {4});
  writeAll("right", 12, name("right", 4), {8});
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 12U);
  EXPECT_EQ(namesOf(found.frames[3]), "left0003.png right0003.png");
  EXPECT_EQ(namesOf(found.frames[4]), "left0004.png? right0004.png");
  EXPECT_EQ(namesOf(found.frames[8]), "left0008.png right0008.png?");
  EXPECT_EQ(namesOf(found.frames[11]), "left0011.png right0011.png");
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_EQ(found.notes[0].name, "pairs");
  EXPECT_THAT(found.notes[0].text,
              AllOf(HasSubstr("1 left missing (left/left0004.png)"), HasSubstr("1 right missing (right/right0008.png)"),
                    HasSubstr("10 of 12 frames are pairs")));
}

TEST_F(Pairing, NamesOfAnyKindTellTheirNumber) {
  const std::vector<std::pair<NameOf, NameOf>> kinds{
      {name("", 6), name("", 6)},
      {name("left", 4), name("right", 0)},                     // zeros ahead on one side alone
      {name("cam0_", 0), name("cam1_frame", 5, "_rect.jpg")},  // numbers of the camera, other words and endings
      {name("img_0_", 3, "_L8.png"), name("img_1_", 3, "_R16.png")},
      {name("2011_09_26_drive_0013_", 10), name("", 3, ".pgm")}};
  for (const auto& [left, right] : kinds) {
    std::filesystem::remove_all(folder_ / "left");
    std::filesystem::remove_all(folder_ / "right");
    writeAll("left", 15, left, {3});
    writeAll("right", 15, right, {5});
    const PairedImages found = pair();
    ASSERT_EQ(found.frames.size(), 15U) << left(0);
    EXPECT_EQ(namesOf(found.frames[2]), left(2) + " " + right(2));
    EXPECT_EQ(namesOf(found.frames[3]), left(3) + "? " + right(3));
    EXPECT_EQ(namesOf(found.frames[5]), left(5) + " " + right(5) + "?");
    EXPECT_EQ(namesOf(found.frames[14]), left(14) + " " + right(14));
  }
}

TEST_F(Pairing, NumbersWithoutZerosAheadAreCounted) {
  for (const char* side : {"left", "right"}) writeAll(side, 40, name("img", 0));
  const Sequence found = sequence();
  for (int i = 0; i < 40; ++i) EXPECT_EQ(found.frames[i].left.filename(), "img" + std::to_string(i) + ".png");
  EXPECT_THAT(found.notes, IsEmpty());
  EXPECT_THAT(found.numbering.places, IsEmpty());
}

TEST_F(Pairing, ASideWithFewerImagesIsPairedByNumber) {
  writeAll("left", 30, name("left", 3));
  writeAll("right", 30, name("right", 3), {10, 11, 12, 20});
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 30U);
  EXPECT_EQ(namesOf(found.frames[29]), "left029.png right029.png");
  EXPECT_THAT(found.notes.at(0).text, AllOf(HasSubstr("4 right missing (right/right010.png, right/right011.png, "
                                                      "right/right012.png and 1 more)"),
                                            HasSubstr("26 of 30")));
}

TEST_F(Pairing, EverySecondImageIsAStepAndNoGap) {
  for (const char* side : {"left", "right"}) writeAll(side, 20, [](int i) { return padded(2 * i, 6) + ".png"; });
  const Sequence found = sequence();
  EXPECT_EQ(found.frames.size(), 20U);
  EXPECT_EQ(found.numbering.step, 2);
  EXPECT_THAT(found.numbering.places, IsEmpty());
  EXPECT_THAT(found.notes, IsEmpty());
}

TEST_F(Pairing, ANumberThatBothSidesLackIsAFrameWithoutImages) {
  for (const char* side : {"left", "right"}) writeAll(side, 20, name(side, 4), {7, 8});
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 20U);
  EXPECT_EQ(namesOf(found.frames[8]), "left0008.png? right0008.png?");
  EXPECT_EQ(namesOf(found.frames[9]), "left0009.png right0009.png");
  EXPECT_THAT(found.notes.at(0).text, AllOf(HasSubstr("2 missing on both sides"), HasSubstr("18 of 20")));
}

TEST_F(Pairing, OverALongGapOnlyTimePasses) {
  for (const char* side : {"left", "right"})
    writeAll(side, 20, [](int i) { return padded(i < 10 ? i : 1000 + i, 6) + ".png"; });
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 20U);
  EXPECT_EQ(found.numbering.places.at(10), 1010);
}

TEST_F(Pairing, UnevenNumbersTellHowFarApartFramesAre) {
  const std::vector<int> numbers{0, 3, 7, 8, 12, 19, 21};
  for (const char* side : {"left", "right"}) writeAll(side, 7, [&](int i) { return padded(numbers[i], 6) + ".png"; });
  const Sequence found = sequence();
  EXPECT_EQ(found.frames.size(), 7U);
  EXPECT_THAT(found.numbering.places, ElementsAre(0, 3, 7, 8, 12, 19, 21));
  EXPECT_THAT(found.notes.at(0).text, HasSubstr("unevenly"));
}

TEST_F(Pairing, TicksOfAClockWithoutAUnitAreEvenlySpaced) {
  for (const char* side : {"left", "right"})
    writeAll(side, 12, [](int i) { return std::to_string(70'000 + 3'000 * i + i * i * 7 % 13) + ".png"; });
  const Sequence found = sequence();
  EXPECT_EQ(found.frames.size(), 12U);
  EXPECT_THAT(found.numbering.places, IsEmpty());
  EXPECT_FALSE(found.stamps_measured);
  EXPECT_THAT(found.notes.at(0).text, HasSubstr("evenly spaced"));
}

TEST_F(Pairing, TimesMayDifferByLessThanHalfAnInterval) {
  constexpr std::int64_t kFirst_ns = 1'403'636'579'763'555'584, kInterval_ns = 33'333'333;
  const auto nameOf = [](std::int64_t later_ns) {
    return [=](int i) { return std::to_string(kFirst_ns + kInterval_ns * i + (i % 3) * later_ns) + ".png"; };
  };
  writeAll("left", 30, nameOf(0), {10});
  writeAll("right", 30, nameOf(2'345), {20});
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 30U);
  ASSERT_EQ(found.stamps.size(), 30U);
  EXPECT_TRUE(found.stamps_measured);
  EXPECT_EQ(found.stamps[2].ns, kFirst_ns + 2 * kInterval_ns);
  EXPECT_EQ(found.stamps[10].ns,
            kFirst_ns + 10 * kInterval_ns + 2'345);  // the right image's, as the left one is missing
  EXPECT_TRUE(found.frames[10].left_missing);
  EXPECT_TRUE(found.frames[20].right_missing);
  EXPECT_EQ(found.frames[29].right.filename(), nameOf(2'345)(29));
}

TEST_F(Pairing, TimesOfSingleImagesAtTheEndsAreLeftOut) {
  const auto nameOf = [](int i) { return std::to_string(1'403'636'579'000'000'000 + 50'000'000LL * i) + ".png"; };
  writeAll("left", 20, nameOf, {0, 19});
  writeAll("right", 20, nameOf, {1});
  const Sequence found = sequence();
  EXPECT_EQ(found.frames.size(), 17U);
  EXPECT_EQ(found.left_out, 3);
  EXPECT_THAT(found.notes.at(0).text, HasSubstr("3 single images before the first pair or after the last"));
}

TEST_F(Pairing, ImagesOfAPairTakenFarApartAreTold) {
  const auto nameOf = [](std::int64_t later_ns) {
    return [=](int i) { return std::to_string(1'403'636'579'000'000'000 + 100'000'000LL * i + later_ns) + ".png"; };
  };
  writeAll("left", 10, nameOf(0));
  writeAll("right", 10, nameOf(20'000'000));
  EXPECT_THAT(sequence().notes.at(0).text, HasSubstr("20 ms apart"));
}

TEST_F(Pairing, ASideOfHalfTheRateLosesNothing) {
  writeAll("left", 40, name("left", 3));
  writeAll("right", 20, [](int i) { return "right" + padded(2 * i, 3) + ".png"; }, {6});
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 20U);
  EXPECT_EQ(namesOf(found.frames[5]), "left010.png right010.png");
  EXPECT_EQ(namesOf(found.frames[6]), "left012.png right012.png?");
  EXPECT_EQ(found.left_out, 20);
  EXPECT_THAT(found.notes.at(0).text, HasSubstr("20 between the pairs are left out"));
}

TEST_F(Pairing, NamesThatTellNothingAreTakenInOrderAndToldSo) {
  writeAll("left", 8, [](int i) { return std::to_string(100 + i) + ".png"; });
  writeAll("right", 8, [](int i) { return std::to_string(5000 + i) + ".png"; });
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 8U);
  EXPECT_EQ(namesOf(found.frames[7]), "107.png 5007.png");
  EXPECT_THAT(found.notes.at(0).text,
              AllOf(HasSubstr("paired in order"), HasSubstr("left/100.png with right/5000.png")));
  write("left", "108.png");
  EXPECT_THAT(error(), AllOf(HasSubstr("holds 9 images"), HasSubstr("holds 8"), HasSubstr("LEFT RIGHT")));
}

TEST_F(Pairing, FewerPairsThanHalfAreRefused) {
  writeAll("left", 20, name("", 3));
  writeAll("right", 20, [](int i) { return padded(i + 15, 3) + ".png"; });
  EXPECT_THAT(error(), AllOf(HasSubstr("of 35 numbers or times"), HasSubstr("only 5"), HasSubstr("left/000.png")));
}

TEST_F(Pairing, WordsThatDifferArePairedByTheirNames) {
  for (const char* side : {"left", "right"})
    for (const char* word : {"a", "b", "c"}) writeAll(side, 5, name(word, 0));
  std::filesystem::remove(folder_ / "left/b2.png");
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 15U);
  EXPECT_EQ(namesOf(found.frames[7]), "b2.png? b2.png");
  EXPECT_EQ(namesOf(found.frames[14]), "c4.png c4.png");
}

TEST_F(Pairing, NumbersOfTwoPlacesAreComparedTogether) {
  const auto nameOf = [](const std::string& side) {
    return [=](int i) { return "aachen_" + padded(i / 6, 6) + "_" + padded(i % 6 + 19, 6) + "_" + side + "8bit.png"; };
  };
  writeAll("left", 18, nameOf("leftImg"), {8});
  writeAll("right", 18, nameOf("rightImg"));
  const Sequence found = sequence();
  ASSERT_EQ(found.frames.size(), 18U);
  EXPECT_EQ(namesOf(found.frames[8]), "aachen_000001_000021_leftImg8bit.png? aachen_000001_000021_rightImg8bit.png");
  EXPECT_EQ(namesOf(found.frames[17]), nameOf("leftImg")(17) + " " + nameOf("rightImg")(17));
}

TEST_F(Pairing, AFewNamesOfAnotherKindAreLeftOut) {
  for (const char* side : {"left", "right"}) writeAll(side, 12, name("frame", 3));
  for (const char* side : {"left", "right"}) write(side, "average.png");
  write("left", "frame003 (copy).png");
  const PairedImages found = pair();
  EXPECT_EQ(found.frames.size(), 12U);
  EXPECT_EQ(found.left_out, 3);
}

TEST_F(Pairing, TwoImagesOfOneNumberAreRefused) {
  for (const char* side : {"left", "right"}) writeAll(side, 5, name("", 6));
  write("right", "000003.jpg");
  EXPECT_THAT(error(), AllOf(HasSubstr("000003.png"), HasSubstr("same number as 000003.jpg")));
}

std::vector<std::int64_t> times_ns(const std::vector<std::string>& names) {
  std::vector<NameParts> parts;
  for (const std::string& name : names) parts.push_back(partsOfName(name));
  const auto times = timesOfNames(parts);
  return times ? times->all_ns : std::vector<std::int64_t>{};
}

TEST(NameTimes, AreReadInTheUnitThatACameraMayHave) {
  EXPECT_THAT(times_ns({"1403636579763555584", "1403636579796888917"}),
              ElementsAre(1403636579763555584, 1403636579796888917));
  EXPECT_THAT(times_ns({"1403636579763555", "1403636579796888"}),
              ElementsAre(1403636579763555000, 1403636579796888000));
  EXPECT_THAT(times_ns({"left_1403636579763", "left_1403636579796"}),
              ElementsAre(1403636579763000000, 1403636579796000000));
  EXPECT_THAT(times_ns({"1311868164.363181", "1311868164.399026"}),
              ElementsAre(1311868164363181000, 1311868164399026000));
  EXPECT_THAT(times_ns({"img_CAMERA1_1261228749.918590_left", "img_CAMERA1_1261228749.968589_left"}),
              ElementsAre(1261228749918590000, 1261228749968589000));
  EXPECT_THAT(times_ns({"0.9", "1.05", "1.2"}), ElementsAre(900000000, 1050000000, 1200000000));
  EXPECT_THAT(times_ns({"1403636579_95000000", "1403636580_5000000"}),  // seconds and nanoseconds, as ROS has them
              ElementsAre(1403636579095000000, 1403636580005000000));
  EXPECT_THAT(times_ns({"33333", "66666", "99999"}), ElementsAre(33333000, 66666000, 99999000));  // of a clock's start
  EXPECT_THAT(times_ns({"1548780000123.45", "1548780000156.7"}), ElementsAre(1548780000123450000, 1548780000156700000));
  EXPECT_THAT(times_ns({"1000000000", "1100000000"}), ElementsAre(1000000000, 1100000000));
  EXPECT_THAT(times_ns({"5033333333", "5066666666"}), ElementsAre(5033333333, 5066666666));
}

TEST(NameTimes, MayBeDates) {
  constexpr std::int64_t kNoon_ns = 1'531'312'608'000'000'000;  // date -u -d '2018-07-11 12:36:48' +%s
  EXPECT_THAT(times_ns({"2018-07-11-12-36-48-100", "2018-07-11-12-36-48-200"}),
              ElementsAre(kNoon_ns + 100'000'000, kNoon_ns + 200'000'000));
  EXPECT_THAT(times_ns({"20180711123648100", "20180711123648150"}),
              ElementsAre(kNoon_ns + 100'000'000, kNoon_ns + 150'000'000));
  EXPECT_THAT(times_ns({"left_20180711_123648_000", "left_20180711_123648_040"}),
              ElementsAre(kNoon_ns, kNoon_ns + 40'000'000));
}

TEST(NameTimes, AreNotWhatMerelyCounts) {
  EXPECT_THAT(times_ns({"000123", "000124", "000125"}), IsEmpty());
  EXPECT_THAT(times_ns({"0000000000", "0000000010", "0000000020"}), IsEmpty());
  EXPECT_THAT(times_ns({"000000", "001000", "002000"}), IsEmpty());
  EXPECT_THAT(times_ns({"v1.01", "v1.02", "v1.03"}), IsEmpty());
  EXPECT_THAT(times_ns({"1000000000", "1000000001", "1000000002"}), IsEmpty());  // as for Kalibr's bagcreater
  EXPECT_THAT(times_ns({"2011_09_26_0001", "2011_09_26_0002"}), IsEmpty());
  EXPECT_THAT(times_ns({"a", "b"}), IsEmpty());
  EXPECT_THAT(times_ns({"99999999999999999999999", "99999999999999999999998"}), IsEmpty());
}

}  // namespace
}  // namespace motorcade
