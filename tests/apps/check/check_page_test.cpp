#include "apps/check/check_page.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "apps/check/finding_guide.hpp"

namespace motorcade {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kWidth_px = 714, kHeight_px = 200;
constexpr StereoCamera kPageCamera{500, 500, 357, 100, 0.5, kWidth_px, kHeight_px};

Image gray() {
  ImagePool pool;
  Image image = pool.acquire(kWidth_px, kHeight_px);
  for (int y = 0; y < kHeight_px; ++y) std::fill_n(image.mutableRow(y), kWidth_px, std::uint8_t{90});
  return image;
}

/// Points all over the image whose partners lie lower by so many rows.
std::vector<EpipolarMatch> lowered(double rows_px) {
  std::vector<EpipolarMatch> matches;
  for (int v = 10; v < kHeight_px; v += 20)
    for (int u = 60; u < kWidth_px; u += 60) matches.push_back({1.0 * u, 1.0 * v, u - 20.0, v + rows_px});
  return matches;
}

/// Counts of pixels that are clearly red, where rows disagree, and green, where they agree.
std::pair<int, int> redAndGreen(const RgbImage& image, int top, int bottom) {
  int red = 0, green = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* pixel = image.at(x, y);
      red += pixel[0] > pixel[1] + 80;
      green += pixel[1] > pixel[0] + 60;
    }
  return {red, green};
}

constexpr int kTop_px = 30, kBottom_px = 30 + kHeight_px - 5;  // of the images in the picture

TEST(EpipolarPicture, TellsRowsThatAgreeFromRowsThatDoNotByColor) {
  const auto good = lowered(0), bad = lowered(4);
  const auto [red, green] = redAndGreen(drawEpipolarLines({{3}, gray(), gray(), good}), kTop_px, kBottom_px);
  EXPECT_EQ(red, 0);
  EXPECT_GT(green, 200);
  const auto [more_red, less_green] = redAndGreen(drawEpipolarLines({{3}, gray(), gray(), bad}), kTop_px, kBottom_px);
  EXPECT_GT(more_red, 200);
  EXPECT_EQ(less_green, 0);
}

TEST(EpipolarPicture, ABarReachesFromTheRowToThePartnerEnlarged) {
  const std::vector<EpipolarMatch> one{{300, 100, 250, 104}};
  const RgbImage image = drawEpipolarLines({{3}, gray(), gray(), one});
  const int second = image.width - kWidth_px, row = 28 + 100;
  const auto isRed = [&](int x, int y) { return image.at(x, y)[0] > image.at(x, y)[1] + 60; };
  EXPECT_TRUE(isRed(700, row)) << "the line";
  EXPECT_TRUE(isRed(second + 250, row + 20)) << "4 px, six times";
  EXPECT_FALSE(isRed(second + 250, row - 8));
  EXPECT_FALSE(isRed(second + 250, row + 40));
}

TEST(EpipolarPicture, ArrowsShowWhatTheGeometryMakesOfTheRows) {
  PairGeometry geometry;
  const auto matches = lowered(0);
  const auto still = redAndGreen(drawRowErrors(gray(), matches, geometry, kPageCamera), 0, 250);
  geometry.errors[static_cast<std::size_t>(RowError::kOffset)].value = 5;
  const auto arrows = redAndGreen(drawRowErrors(gray(), matches, geometry, kPageCamera), 0, 250);
  EXPECT_EQ(still.first, 0);
  EXPECT_GT(arrows.first, 2000);
  EXPECT_GT(drawRowErrors(gray(), {}, geometry, kPageCamera).height, 250) << "without a match";
}

TEST(PairGeometry, PredictsTheRowErrorsThatItWasEstimatedFrom) {
  auto matches = lowered(3);
  for (EpipolarMatch& match : matches) match.v_right_px += 0.01 * (match.u_left_px - kPageCamera.cx_px);
  const PairGeometry geometry = estimatePairGeometry(matches, kPageCamera);
  for (const EpipolarMatch& match : matches)
    EXPECT_NEAR(predictedRowError_px(geometry, kPageCamera, match.u_left_px, match.v_left_px, match.disparity_px()),
                match.rowDifference_px(), 0.05);  // the prior pulls it a little to zero
  EXPECT_NEAR(rowRms_px(lowered(3)), 3, 1e-9);
  EXPECT_EQ(rowRms_px({}), 0);
}

TEST(CheckPage, StandsInOneFileAndEscapesWhatComesFromOutside) {
  const InputCheck check(kPageCamera);
  const auto matches = lowered(4);
  const std::string page = checkPage({.sequence = "<script>drive</script>",
                                      .camera = kPageCamera,
                                      .check = &check,
                                      .findings = {{"rows", "4 (+-0.1) px <lower>; rectify", true}},
                                      .worst = {{{7}, gray(), gray(), matches}}});
  EXPECT_THAT(page, AllOf(HasSubstr("&lt;script&gt;drive"), Not(HasSubstr("<script"))));
  EXPECT_THAT(page, AllOf(HasSubstr("4 (±0.1) px &lt;lower&gt;."), HasSubstr("worthless"), HasSubstr("frame 7")));
  EXPECT_THAT(page, AllOf(HasSubstr("src=\"data:image/jpeg;base64,"), Not(HasSubstr("http"))));
}

TEST(CheckPage, WithoutFindingsItSaysSoWithWhatWasMeasured) {
  const InputCheck check(kPageCamera);
  const std::string page =
      checkPage({.sequence = "drive", .camera = kPageCamera, .check = &check, .findings = {}, .worst = {}});
  EXPECT_THAT(page, AllOf(HasSubstr("nothing is wrong"), HasSubstr("No pair has points"), HasSubstr("714")));
  for (const RowErrorName& name : kRowErrorNames) EXPECT_THAT(page, HasSubstr(name.title));
}

TEST(CheckPage, ACalibrationOfZeroStillHasAPage) {
  const InputCheck check((StereoCamera{}));
  const std::string page = checkPage({.sequence = "drive",
                                      .camera = {},
                                      .check = &check,
                                      .findings = {{"calibration", "the baseline is 0; its unit is the meter", true}},
                                      .worst = {}});
  EXPECT_THAT(page, AllOf(HasSubstr("its unit is the meter"), Not(HasSubstr("nan"))));
}

TEST(FindingGuide, KnowsEveryFindingByItsOwnWords) {
  for (const char* name : {"rows", "roll", "zoom", "yaw", "lift", "ahead", "distortion", "exchanged", "apart", "frozen",
                           "exposure", "blur", "noise", "times", "points", "calibration"}) {
    EXPECT_NE(guideTo(name).title, name);
    EXPECT_GT(guideTo(name).mend.size(), 20U) << name;
  }
  EXPECT_EQ(guideTo("other").title, "other");
}

}  // namespace
}  // namespace motorcade
