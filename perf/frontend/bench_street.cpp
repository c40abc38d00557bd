#include "perf/frontend/bench_street.hpp"

#include <map>
#include <memory>

#include "frontend/features/feature_preparation.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade::perf {
namespace {

constexpr double kGrowth = 1.02;  // of the image from one frame to the next

FeaturesPtr pairAt(const StereoCamera& camera, int number, double growth) {
  const test::Texture texture(7, 3, 40);
  const double scale = camera.width_px / 1242.0;
  const auto disparity = [&](double y) { return scale * (8 + 60 * y / camera.height_px); };
  const auto gray = [&](double x, double y) {
    return texture(camera.cx_px + (x - camera.cx_px) / growth, camera.cy_px + (y - camera.cy_px) / growth);
  };
  const auto seed = static_cast<unsigned>(number);
  const Image left = test::render(camera.width_px, camera.height_px, gray, {.noise = 2, .seed = 2 * seed + 1});
  const Image right =
      test::render(camera.width_px, camera.height_px, [&](double x, double y) { return gray(x + disparity(y), y); },
                   {.noise = 2, .seed = 2 * seed + 2});
  const FeaturePreparation prepare(FeaturePreparation::Params{});
  return prepare(test::stereoFrame(number, left, right));
}

}  // namespace

StereoCamera benchCamera(int width_px) {
  const double scale = width_px / 1242.0;
  return {.fx_px = 720 * scale,
          .fy_px = 720 * scale,
          .cx_px = 620 * scale,
          .cy_px = 188 * scale,
          .baseline_m = 0.54,
          .width_px = width_px,
          .height_px = static_cast<int>(375 * scale)};
}

const BenchStreet& benchStreet(int width_px) {
  static std::map<int, BenchStreet> streets;
  if (const auto found = streets.find(width_px); found != streets.end()) return found->second;
  const StereoCamera camera = benchCamera(width_px);
  return streets[width_px] = {.camera = camera, .before = pairAt(camera, 0, 1), .now = pairAt(camera, 1, kGrowth)};
}

}  // namespace motorcade::perf
