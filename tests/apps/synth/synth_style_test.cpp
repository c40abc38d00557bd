#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>

#include "apps/synth/output/sequence_writer.hpp"
#include "apps/synth/rendering/film.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "apps/synth/scenes/style.hpp"
#include "tests/apps/synth/rendered_scene.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade::synth {
namespace {

WriteOptions twoSmallFrames(Style style) {
  WriteOptions options;
  options.frames = 2;
  options.camera = kittiCamera(248, 75);
  options.render.style = style;
  return options;
}

std::vector<std::uint8_t> pictured(const std::string& scene_name, int frame, Style style, int threads = 2) {
  const Scene scene = makeScene(scene_name, 3);
  const RenderOptions options{.threads = threads, .style = style};
  return pixels(render(FrameScene(scene, frame, true), kittiCamera(248, 75), StereoSide::kLeft, options).image);
}

double mean(const std::vector<std::uint8_t>& levels) {
  return std::accumulate(levels.begin(), levels.end(), 0.0) / static_cast<double>(levels.size());
}

TEST(SynthStyle, AnUnknownOneIsRefusedWithTheNamesOfAll) {
  EXPECT_THAT([] { styleOf("fim"); }, testing::ThrowsMessage<std::invalid_argument>(testing::AllOf(
                                          testing::HasSubstr("fim"), testing::HasSubstr("plain, film"))));
  for (const auto& name : styleNames()) EXPECT_NO_THROW(styleOf(name));
}

TEST(SynthStyle, PlainIsTheDefault) {
  const test::TemporaryFolder folder;
  WriteOptions options = twoSmallFrames(Style::kFilm);
  options.render = {};
  writeSequence(makeScene("urban", 3), folder / "default", options);
  writeSequence(makeScene("urban", 3), folder / "plain", twoSmallFrames(styleOf("plain")));
  for (const char* image : {"image_0/000001.png", "image_1/000001.png"})
    EXPECT_EQ(test::contentOf(folder / "default" / image), test::contentOf(folder / "plain" / image));
}

TEST(SynthStyle, FilmChangesTheImagesAndNothingOfTheTruth) {
  const test::TemporaryFolder folder;
  const Scene scene = makeScene("traffic", 3);
  writeSequence(scene, folder / "plain", twoSmallFrames(Style::kPlain));
  writeSequence(scene, folder / "film", twoSmallFrames(Style::kFilm));
  for (const char* file : {"disp/000001.png", "instance/000001.png", "poses.txt", "label_02.txt", "object_poses.txt",
                           "calib.txt", "times.txt"})
    EXPECT_EQ(test::contentOf(folder / "plain" / file), test::contentOf(folder / "film" / file)) << file;
  for (const char* image : {"image_0/000001.png", "image_1/000001.png"})
    EXPECT_NE(test::contentOf(folder / "plain" / image), test::contentOf(folder / "film" / image)) << image;
}

TEST(SynthStyle, FilmIsTheSameForASeedAndAnyThreadCount) {
  EXPECT_EQ(pictured("lead", 4, Style::kFilm, 1), pictured("lead", 4, Style::kFilm, 3));
  EXPECT_NE(pictured("lead", 4, Style::kFilm), pictured("lead", 5, Style::kFilm));
}

TEST(SynthStyle, FilmKeepsTheBrightnessButForVignetteAndExposure) {
  constexpr double kVignette = 1 - 0.22 / 3, kTextures = 0.1, kExposure = 0.15;  // a wide image loses a third
  for (const auto& name : sceneNames()) {
    const double ratio = mean(pictured(name, 12, Style::kFilm)) / mean(pictured(name, 12, Style::kPlain));
    EXPECT_NEAR(ratio, kVignette, kVignette * (kExposure + kTextures)) << name;
  }
}

TEST(SynthStyle, ExposureWandersSlowlyAndLittleBetweenTheCameras) {
  double least = 1, most = 1;
  for (double t_s = 0; t_s < 20; t_s += 0.1) {
    const auto gain = [](double at_s, bool right) { return exposureGain({1, 1, right, at_s, 0, 5, 0}); };
    const double now = gain(t_s, false);
    EXPECT_NEAR(gain(t_s + 0.1, false), now, 0.025);  // per frame: the sines' slopes
    EXPECT_NEAR(gain(t_s, true) / now, 1, 0.0401);
    least = std::min(least, now);
    most = std::max(most, now);
  }
  EXPECT_LT(least, 0.92);
  EXPECT_GT(most, 1.08);
}

TEST(SynthStyle, TheExposureOfALapRepeats) {
  const auto gain = [](double at_s) { return exposureGain({1, 1, true, at_s, 60, 5, 0}); };
  for (double t_s = 0; t_s < 3; t_s += 0.3) EXPECT_NEAR(gain(t_s), gain(t_s + 60), 1e-5);  // single precision
}

TEST(SynthStyle, TheLensBlursAndTheFilmHasGrain) {
  constexpr int kSize = 64;
  std::vector<float> levels(kSize * kSize, 128);
  develop(levels, {kSize, kSize, false, 0, 0, 5, 9});
  float rough = 0;  // mean square difference of neighbors in the middle, where the vignette is flat
  for (int x = 16; x < 48; ++x) rough += std::pow(levels[32 * kSize + x] - levels[32 * kSize + x + 1], 2.0F) / 32;
  EXPECT_GT(rough, 1);
  EXPECT_LT(rough, 40);
  std::vector<float> dot(kSize * kSize, 0);
  dot[32 * kSize + 32] = 200;
  develop(dot, {kSize, kSize, false, 0, 0, 5, 9});
  EXPECT_LT(dot[32 * kSize + 32], 120);
  EXPECT_GT(dot[32 * kSize + 33], 12);
}

}  // namespace
}  // namespace motorcade::synth
