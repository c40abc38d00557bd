#include "core/parameters.hpp"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

enum class Detector { kFast, kExact };

struct ToyParams {
  int count = 5;
  double reach_m = 2;
  bool twice = false;
  Detector detector = Detector::kFast;
};

std::vector<Parameter> parametersOf(ToyParams& params) {
  return {numberParameter("count", params.count, {1, 10}, "more are better"),
          numberParameter("reach_m", params.reach_m, {0, 2.5}, "farther sees more"),
          switchParameter("twice", params.twice, "does it twice"),
          choiceParameter<Detector>("detector", params.detector,
                                    {{"fast", Detector::kFast}, {"exact", Detector::kExact}}, "which one")};
}

TEST(Parameters, FindsNoProblemInValuesWithinTheirRanges) {
  EXPECT_TRUE(problemsOf(ToyParams{}).empty());
  EXPECT_TRUE(problemsOf(ToyParams{.count = 1, .reach_m = 0}).empty());
  EXPECT_TRUE(problemsOf(ToyParams{.count = 10, .reach_m = 2.5}).empty());
}

TEST(Parameters, NamesEachValueThatIsOutOfItsRange) {
  EXPECT_THAT(problemsOf(ToyParams{.count = 0, .reach_m = 2.6}),
              ElementsAre(Field(&ParameterProblem::name, "count"), Field(&ParameterProblem::name, "reach_m")));
  EXPECT_EQ(problemsOf(ToyParams{.count = 11}).front().text(), "'count' is 11; write 1 to 10");
}

TEST(Parameters, RefusesInfiniteDenormalAndMissingNumbersInEveryRange) {
  using Limits = std::numeric_limits<double>;
  for (const double bad : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), Limits::denorm_min(), 1e300})
    EXPECT_EQ(problemsOf(ToyParams{.reach_m = bad}).size(), 1U) << bad;
}

TEST(Parameters, ThrowsInAConstructorWithNameAndRange) {
  EXPECT_EQ(requireValid(ToyParams{.count = 3}).count, 3);
  try {
    requireValid(ToyParams{.count = -1});
    FAIL() << "-1 was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'count' is -1"), HasSubstr("1 to 10")));
  }
}

TEST(Parameters, ChoicesReadAndSetTheEnum) {
  ToyParams params;
  const auto parameters = parametersOf(params);
  const auto& choice = std::get<Choice>(parameters.back().value);
  EXPECT_EQ(choice.get(), 0U);
  choice.set(1);
  EXPECT_EQ(params.detector, Detector::kExact);
  EXPECT_EQ(choice.get(), 1U);
  EXPECT_EQ(parameters.back().allowed(), "\"fast\" or \"exact\"");
}

}  // namespace
}  // namespace motorcade
