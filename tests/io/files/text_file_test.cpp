#include "io/files/text_file.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kFile = "poses.txt";

/// Reads `text` as line 7 of a file.
template <class Action>
auto reading(const std::string& text, const Action& action, char separator = ' ') {
  const TextLine line{.number = 7, .text = text};
  FieldReader fields(kFile, line, separator);
  return action(fields);
}

template <class Action>
std::string errorOf(const std::string& text, const Action& action, char separator = ' ') {
  return messageOf<InputError>([&] { reading(text, action, separator); });
}

const auto kNumber = [](FieldReader& fields) { return fields.number("a speed"); };
const auto kInteger = [](FieldReader& fields) { return fields.integer("a frame"); };
const auto kPose = [](FieldReader& fields) { return fields.pose("a pose"); };

TEST(FieldReader, TakesFieldsBetweenAnyRunOfBlanks) {
  reading(" \tcar  3 \t-1.5e1  ", [](FieldReader& fields) {
    EXPECT_EQ(fields.word("a type"), "car");
    EXPECT_EQ(fields.integer("a frame"), 3);
    EXPECT_FALSE(fields.atEnd());
    EXPECT_EQ(fields.number("a speed"), -15);
    EXPECT_TRUE(fields.atEnd());
    fields.expectEnd();
    return 0;
  });
}

TEST(FieldReader, TakesEmptyFieldsBetweenOtherSeparators) {
  reading(
      "a,,b,",
      [](FieldReader& fields) {
        EXPECT_EQ(fields.word("one"), "a");
        EXPECT_EQ(fields.word("two"), "");
        EXPECT_EQ(fields.word("three"), "b");
        EXPECT_FALSE(fields.atEnd());
        EXPECT_EQ(fields.word("four"), "");
        EXPECT_TRUE(fields.atEnd());
        return 0;
      },
      ',');
}

TEST(FieldReader, TakesNumbersWithASign) {
  EXPECT_EQ(reading("+2.5", kNumber), 2.5);
  EXPECT_EQ(reading("-7", kInteger), -7);
}

TEST(FieldReader, NamesFileLineAndFieldOfWhatIsNoNumber) {
  EXPECT_THAT(errorOf("fast", kNumber),
              AllOf(HasSubstr("poses.txt, line 7: "), HasSubstr("'fast' is not a number (a speed)")));
  EXPECT_THAT(errorOf("1.5x", kNumber), HasSubstr("'1.5x' is not a number"));
  EXPECT_THAT(errorOf("1,5", kNumber), HasSubstr("'1,5' is not a number"));
  EXPECT_THAT(errorOf("nan", kNumber), HasSubstr("'nan' is not finite (a speed)"));
  EXPECT_THAT(errorOf("1.5", kInteger), HasSubstr("'1.5' is not a whole number (a frame)"));
  EXPECT_THAT(errorOf("99999999999999999999", kInteger), HasSubstr("is not a whole number"));
}

TEST(FieldReader, RefusesNumbersWhoseProductsWouldNotBeFinite) {
  EXPECT_EQ(reading("-1e50", kNumber), -1e50);
  EXPECT_THAT(errorOf("1e51", kNumber), HasSubstr("'1e51' is too large (a speed)"));
}

TEST(FieldReader, ShowsNoByteThatATerminalTakesForACommandAndNoLongText) {
  EXPECT_THAT(errorOf("1\x1b[2J\xff", kNumber), HasSubstr("'1?[2J?' is not a number"));
  EXPECT_THAT(errorOf("\a7", kInteger), HasSubstr("'?7' is not a whole number"));
  const auto read_column = [](FieldReader& fields) { return fields.number("speed\xff"); };  // a name from a header
  EXPECT_THAT(errorOf("", read_column), HasSubstr("ends before speed?"));
  std::string long_text(100000, '7');
  long_text.back() = 'x';
  EXPECT_THAT(errorOf(long_text, kNumber), HasSubstr("'" + std::string(40, '7') + "...' is not"));
}

TEST(FieldReader, NamesWhatIsMissingAndWhatIsLeft) {
  EXPECT_THAT(errorOf("", kNumber), HasSubstr("ends before a speed"));
  EXPECT_THAT(errorOf("1 2",
                      [](FieldReader& fields) {
                        fields.number("a speed");
                        fields.expectEnd();
                        return 0;
                      }),
              HasSubstr("has more fields than expected: '2'"));
}

TEST(FieldReader, PutsARotationOfFewDigitsBackOntoTheGroup) {
  const SE3 T = reading("0.8 -0.6001 0 1 0.6 0.8 0 2 0 0 1 3", kPose);
  const Eigen::Matrix3d& R = T.rotation();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(T.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(FieldReader, RefusesAMatrixThatIsNoRotation) {
  EXPECT_THAT(errorOf("2 0 0 0 0 1 0 0 0 0 1 0", kPose), HasSubstr("a pose holds no rotation matrix"));
  EXPECT_THAT(errorOf("-1 0 0 0 0 1 0 0 0 0 1 0", kPose), HasSubstr("a pose holds no rotation matrix"));
  EXPECT_THAT(errorOf("1 0 0 0 0 1 0 0 0 0 1", kPose), HasSubstr("ends before a pose"));
}

class TextFile : public testing::Test {
 protected:
  std::vector<std::string> linesOf(const std::string& content, LastLine last_line = LastLine::kKeep) {
    std::vector<std::string> lines;
    for (const TextLine& line : readLines(folder_.write("a.txt", content), last_line))
      lines.push_back(std::to_string(line.number) + ":" + line.text);
    return lines;
  }

  test::TemporaryFolder folder_;
};

TEST_F(TextFile, GivesTheLinesThatAreNotBlankWithTheirNumbers) {
  EXPECT_EQ(linesOf("\xEF\xBB\xBF"
                    "a\r\n\n \t\nb c\n"),
            (std::vector<std::string>{"1:a", "4:b c"}));
}

TEST_F(TextFile, LeavesOutALastLineThatWasCutWhereAsked) {
  EXPECT_EQ(linesOf("a\nhal"), (std::vector<std::string>{"1:a", "2:hal"}));
  EXPECT_EQ(linesOf("a\nhal", LastLine::kDropIfCut), (std::vector<std::string>{"1:a"}));
}

TEST_F(TextFile, NamesAFileThatCannotBeRead) {
  EXPECT_THAT(messageOf<InputError>([&] { readWhole(folder_ / "none.txt"); }),
              AllOf(HasSubstr("none.txt"), HasSubstr("cannot be opened")));
  EXPECT_THAT(messageOf<InputError>([&] { readWhole(folder_.path()); }),
              HasSubstr("is a folder, a regular file is needed"));
  EXPECT_THAT(messageOf<InputError>([&] { readWhole(folder_.write("long.txt", "12345"), 4); }),
              HasSubstr("is too large (5 bytes, at most 4)"));
}

}  // namespace
}  // namespace motorcade
