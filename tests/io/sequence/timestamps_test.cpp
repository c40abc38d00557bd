#include "io/sequence/timestamps.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class TimestampFile : public testing::Test {
 protected:
  std::vector<std::int64_t> read_ns(const std::string& content) {
    std::vector<std::int64_t> stamps_ns;
    for (const Timestamp stamp : readTimestamps(folder_.write("times.txt", content))) stamps_ns.push_back(stamp.ns);
    return stamps_ns;
  }
  std::string errorOf(const std::string& content) {
    return messageOf<InputError>([&] { read_ns(content); });
  }

  test::TemporaryFolder folder_;
};

TEST_F(TimestampFile, ReadsSecondsToTheNanosecond) {
  EXPECT_THAT(read_ns("0\n0.1\n 12.000000345 \n1403636579.763555584\n"),
              ElementsAre(0, 100'000'000, 12'000'000'345, 1'403'636'579'763'555'584));
}

TEST_F(TimestampFile, ReadsTheScientificFormOfTheOdometryBenchmark) {
  EXPECT_THAT(read_ns("0.000000e+00\n1.036224e-01\n2.072500e+01\n"), ElementsAre(0, 103'622'400, 20'725'000'000));
}

TEST_F(TimestampFile, ReadsDatesOfTheRawLayoutAsUtc) {
  EXPECT_THAT(read_ns("1970-01-02 00:00:01.5\n2011-09-26 13:10:51.175862102\n2012-02-29T23:59:59\n"),
              ElementsAre(86'401'500'000'000, 1'317'042'651'175'862'102, 1'330'559'999'000'000'000));
}

TEST_F(TimestampFile, MayBeEmptyOrEndWithBlankLines) {
  EXPECT_THAT(read_ns(""), ElementsAre());
  EXPECT_THAT(read_ns("1\r\n\r\n2\r\n\n"), ElementsAre(1'000'000'000, 2'000'000'000));
}

TEST_F(TimestampFile, NamesTheLineThatIsNotLaterThanTheOneBefore) {
  EXPECT_THAT(errorOf("1\n2\n2\n"),
              AllOf(HasSubstr("times.txt, line 3"), HasSubstr("the time is not later than the one before")));
}

/// 63 bits of nanoseconds are 292 years: the year 9999 does not fit, nor do the seconds from the first time to the
/// last.
TEST_F(TimestampFile, RefusesTimesThatDoNotFitIntoNanoseconds) {
  for (const char* far : {"9999-12-31 23:59:59\n", "4500000000\n", "-9e9\n", "1700-01-01 00:00:00\n"})
    EXPECT_THAT(errorOf(far), HasSubstr("times.txt, line 1")) << far;
  EXPECT_THAT(errorOf("2011-02-03 13:10:61\n"), HasSubstr("line 1"));
  EXPECT_THAT(read_ns("-4499999999\n4499999999\n"), ElementsAre(-4'499'999'999'000'000'000, 4'499'999'999'000'000'000));
}

TEST_F(TimestampFile, ReadsTheUnitInWhichACameraMayHaveTakenImages) {
  EXPECT_THAT(read_ns("0\n33.366\n66.733\n"), ElementsAre(0, 33'366'000, 66'733'000));
  EXPECT_THAT(read_ns("5000033\n5033366\n5066700\n"), ElementsAre(5'000'033'000, 5'033'366'000, 5'066'700'000));
  EXPECT_THAT(read_ns("1403636579763555584\n1403636579796888917\n"),
              ElementsAre(1'403'636'579'763'555'584, 1'403'636'579'796'888'917));
  EXPECT_THAT(read_ns("0\n2\n4\n"), ElementsAre(0, 2'000'000'000, 4'000'000'000));
  EXPECT_THAT(read_ns("0\n0.1\n5000\n10000\n"), ElementsAre(0, 100'000'000, 5'000'000'000'000, 10'000'000'000'000));
}

TEST_F(TimestampFile, NamesTheLineThatIsNoTime) {
  EXPECT_THAT(errorOf("0.1\nnoon\n"), AllOf(HasSubstr("line 2"), HasSubstr("'noon' is not a number")));
  EXPECT_THAT(errorOf("0.1 0.2\n"), HasSubstr("more fields than expected"));
  EXPECT_THAT(errorOf("2011-02-30 13:10:51\n"), HasSubstr("line 1"));
  EXPECT_THAT(errorOf("inf\n"), HasSubstr("is not finite"));
  EXPECT_THAT(errorOf("4.6e9\n"), HasSubstr("the time is out of range; seconds are expected"));
  EXPECT_THAT(errorOf("1403636579763555584\n"), HasSubstr("seconds are expected"));  // nanoseconds
}

}  // namespace
}  // namespace motorcade
