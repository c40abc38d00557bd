#include "apps/draw/tags.hpp"

#include <random>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr Rectangle kArea{0, 0, 1241, 374};

TEST(LabelLayout, LabelsOfACrowdNeitherOverlapNorLeaveTheArea) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> left(-50, 1250), top(100, 300), size(5, 200);
  std::vector<LabelRequest> requests;
  for (int i = 0; i < 25; ++i) requests.push_back({{left(random), top(random), size(random), size(random)}, 130, 34});
  const auto places = placeLabels(requests, kArea);
  int placed = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) continue;
    ++placed;
    EXPECT_TRUE(kArea.contains(*places[i]));
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_EQ(places[i]->overlap(places[k].value_or(Rectangle{})), 0) << i << " and " << k;
  }
  EXPECT_GE(placed, 20);
}

TEST(LabelLayout, ALabelStandsAboveWhatItBelongsToWhereThereIsRoom) {
  const LabelRequest request{{600, 200, 80, 60}, 130, 34};
  const auto place = placeLabels(std::vector{request}, kArea).front();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->left, 600);
  EXPECT_LT(place->bottom(), 200);
  EXPECT_GT(place->bottom(), 190);
}

TEST(LabelLayout, ALabelAtTheEdgeMovesInside) {
  for (const Rectangle anchor : {Rectangle{1200, 5, 80, 60}, Rectangle{-40, 330, 80, 60}}) {
    const auto place = placeLabels(std::vector<LabelRequest>{{anchor, 130, 34}}, kArea).front();
    ASSERT_TRUE(place);
    EXPECT_TRUE(kArea.contains(*place));
  }
}

TEST(LabelLayout, ALabelHidesNoOtherObjectWhereThereIsAWayAround) {
  const Rectangle lower{600, 200, 80, 60}, above{600, 150, 130, 45};
  const auto place = placeLabels(std::vector<LabelRequest>{{lower, 130, 34}, {above, 10, 10}}, kArea).front();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->overlap(above), 0);
}

TEST(LabelLayout, ALabelWithoutRoomStaysAway) {
  const LabelRequest request{{5, 5, 10, 10}, 130, 34};
  EXPECT_FALSE(placeLabels(std::vector{request}, {0, 0, 100, 100}).front());
  const auto places = placeLabels(std::vector{request, request}, {0, 0, 131, 36});
  EXPECT_TRUE(places[0]);
  EXPECT_FALSE(places[1]);
}

}  // namespace
}  // namespace motorcade
