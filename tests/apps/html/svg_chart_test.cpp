#include "apps/html/svg_chart.hpp"

#include <cmath>
#include <limits>
#include <regex>

#include <gmock/gmock.h>

namespace motorcade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// All y coordinates of the path that has this class.
std::vector<double> heightsOf(const std::string& svg, const std::string& name) {
  const auto begin = svg.find(" d=\"", svg.find("class=\"" + name + "\"")) + 4;
  const std::string path = svg.substr(begin, svg.find('"', begin) - begin);
  std::vector<double> heights;
  const std::regex point("[ML][-0-9.]+ ([-0-9.]+)");
  for (auto at = std::sregex_iterator(path.begin(), path.end(), point); at != std::sregex_iterator(); ++at)
    heights.push_back(std::stod((*at)[1]));
  return heights;
}

TEST(Ticks, AreRoundNumbersWithinTheRange) {
  EXPECT_THAT(ticksBetween(0, 10, 5), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(ticksBetween(-3, 8, 3), ElementsAre(0, 5));
  EXPECT_EQ(ticksBetween(0, 0.0043, 4).size(), 3u);  // 0, .002, .004
}

TEST(LineChart, ALineIsBrokenWhereNothingIsKnown) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = lineChart(
      {.x = "s", .y = "m"}, {{.name = "way", .color = "red", .points = {{0, 1}, {1, 2}, {2, unknown}, {3, 1}}}});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const auto begin = svg.find(" d=\"", svg.find("class=\"line\"")) + 4;
  EXPECT_EQ(countOf(svg.substr(begin, svg.find('"', begin) - begin), "M"), 2u);
}

TEST(LineChart, ABreakStaysOneWhereALongLineIsThinned) {
  ChartLine line{.name = "", .color = "red"};
  for (int i = 0; i < 4000; ++i) {
    if (i == 1001 || i == 2002) line.points.push_back(lineBreak());
    line.points.emplace_back(i, 1);
    line.half_width.resize(line.points.size(), 0.5);
  }
  const std::string svg = lineChart({.x = "s", .y = "m"}, {line});
  for (const char* part : {"line", "band"}) {
    const auto begin = svg.find(" d=\"", svg.find("class=\"" + std::string(part) + "\"")) + 4;
    const std::string path = svg.substr(begin, svg.find('"', begin) - begin);
    EXPECT_EQ(countOf(path, "M"), 3u) << part;
    EXPECT_LT(countOf(path, "L"), 2000u) << part;
  }
}

TEST(LineChart, ASinglePointBetweenBreaksIsADot) {
  const std::string svg =
      lineChart({.x = "s", .y = "m"},
                {{.name = "", .color = "red", .points = {{0, 1}, lineBreak(), {2, 1}, lineBreak(), {3, 1}, {4, 1}}}});
  EXPECT_EQ(countOf(svg, "h0"), 2u);
}

TEST(LineChart, AWideChartSaysThatItGoesOnWhereTheScreenIsNarrow) {
  const std::string wide = lineChart({.x = "m", .y = "m", .wide = true}, {});
  EXPECT_THAT(wide, HasSubstr("<p class=\"swipe\">Scroll sideways"));
  EXPECT_THAT(lineChart({.x = "m", .y = "m"}, {}), Not(HasSubstr("swipe")));
}

TEST(LineChart, HigherValuesStandHigherAndBandsStayOnTheSheet) {
  const std::string svg =
      lineChart({.x = "s", .y = "m/s"},
                {{.name = "speed", .color = "red", .points = {{0, 5}, {1, 6}, {2, 7}}, .half_width = {500, 0.5, 0.5}}});
  const auto line = heightsOf(svg, "line"), band = heightsOf(svg, "band");
  ASSERT_EQ(line.size(), 3u);
  EXPECT_GT(line[0], line[1]);  // SVG counts from the top
  EXPECT_GT(line[0] - line[2], 20) << "an unsure first value must not flatten the others";
  ASSERT_EQ(band.size(), 6u);
  for (const double height : band) {
    EXPECT_GE(height, 0);
    EXPECT_LE(height, 250);
  }
}

TEST(LineChart, AMapHasTheSameScaleBothWays) {
  const std::string svg = lineChart({.x = "m", .y = "m", .equal_scales = true},
                                    {{.name = "", .color = "red", .points = {{0, 0}, {100, 30}}}});
  const auto begin = svg.find(" d=\"M", svg.find("class=\"line\"")) + 5;
  double from_x = 0, from_y = 0, to_x = 0, to_y = 0;
  ASSERT_EQ(std::sscanf(svg.c_str() + begin, "%lf %lfL%lf %lf", &from_x, &from_y, &to_x, &to_y), 4);
  EXPECT_NEAR((to_x - from_x) / 100, (from_y - to_y) / 30, 0.01);  // a tenth of a pixel in thirty meters
}

TEST(LineChart, NamesItsLinesInTheLegendAndEscapesThem) {
  const std::string svg =
      lineChart({.x = "s", .y = "m"}, {{.name = "a < b", .color = "red", .points = {{0, 1}, {1, 2}}},
                                       {.name = "", .color = "blue", .points = {{0, 1}, {1, 2}}}});
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  EXPECT_EQ(countOf(svg, "<rect"), 1u);
}

TEST(LineChart, AMarkStandsAtTheLastPointAndWithinTheSheet) {
  const std::string svg =
      lineChart({.x = "s", .y = "m"}, {{.name = "", .color = "red", .points = {{0, 1}, {2, 2}}, .mark = "at the edge"},
                                       {.name = "", .color = "blue", .points = {{0, 1}, {1, 2}}, .mark = "in between"},
                                       {.name = "", .color = "green", .points = {{0, 1}, {1, 2}}}});
  EXPECT_EQ(countOf(svg, "<circle"), 2u);
  EXPECT_THAT(svg, HasSubstr(R"(text-anchor="end">at the edge)"));
  EXPECT_THAT(svg, HasSubstr(R"(text-anchor="start">in between)"));
  const auto numberAfter = [&](const std::string& word, std::size_t from) {
    return std::stod(svg.substr(svg.find(word, from) + word.size()));
  };
  const auto red = svg.find("stroke:red"), dot = svg.find("fill:red") - 40;
  const auto second = svg.find('L', svg.find(" d=\"M", red));
  EXPECT_NEAR(std::stod(svg.substr(second + 1)), numberAfter("cx=\"", dot - 20), 0.11);
}

TEST(BarChart, PartsStandOnOneAnother) {
  const std::string svg =
      barChart({.x = "frame", .y = "ms"}, {{"one", "red"}, {"two", "blue"}}, {{0, 1, {3, 2}}, {1, 2, {1, 0}}});
  const auto path = [&](const std::string& color) {
    const auto begin = svg.find(" d=\"", svg.find("fill:" + color)) + 4;
    return svg.substr(begin, svg.find('"', begin) - begin);
  };
  double left = 0, top_of_first = 0, right = 0, bottom = 0, top_of_second = 0, bottom_of_second = 0;
  ASSERT_EQ(std::sscanf(path("red").c_str(), "M%lf %lfH%lfV%lf", &left, &top_of_first, &right, &bottom), 4);
  ASSERT_EQ(std::sscanf(path("blue").c_str(), "M%lf %lfH%lfV%lf", &left, &top_of_second, &right, &bottom_of_second), 4);
  EXPECT_NEAR(bottom_of_second, top_of_first, 0.11);
  EXPECT_NEAR((bottom - top_of_first) / 3, (bottom_of_second - top_of_second) / 2, 0.11);
  EXPECT_EQ(countOf(path("blue"), "M"), 1u) << "a part of nothing has no bar";
}

TEST(Charts, OfNothingAreEmptySheets) {
  EXPECT_THAT(lineChart({.x = "s", .y = "m"}, {}), HasSubstr("<svg"));
  EXPECT_THAT(barChart({.x = "s", .y = "m"}, {{"", "red"}}, {}), HasSubstr("<svg"));
  EXPECT_THAT(lineChart({.x = "s", .y = "m"}, {{.name = "", .color = "red", .points = {{1, 1}}}}),
              Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace motorcade
