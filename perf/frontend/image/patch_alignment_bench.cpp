#include <vector>

#include <benchmark/benchmark.h>

#include "frontend/image/patch_alignment.hpp"
#include "perf/frontend/bench_street.hpp"

/// Benchmarks whose items are patches, at all corners of an image 1242 px wide.
namespace motorcade::perf {
namespace {

constexpr int kWidth_px = 1242;

/// Corners around which a patch and its search lie well inside the image.
std::vector<Corner> innerCorners() {
  constexpr float kBorder_px = 90;
  const BenchStreet& street = benchStreet(kWidth_px);
  std::vector<Corner> inner;
  for (const Corner& corner : street.before->corners)
    if (street.camera.inLeftImage(corner.u_px, corner.v_px, kBorder_px)) inner.push_back(corner);
  return inner;
}

void BM_MakeTemplate(benchmark::State& state) {
  const Image& image = benchStreet(kWidth_px).before->left.levels[0];
  const auto corners = innerCorners();
  const auto window_px = static_cast<int>(state.range(0));
  for (auto _ : state)
    for (const Corner& corner : corners)
      benchmark::DoNotOptimize(
          makeTemplate(image, corner.u_px + 0.3F, corner.v_px + 0.4F, window_px, PatchDeformation::kScale));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(corners.size()));
}
BENCHMARK(BM_MakeTemplate)->Arg(7)->Arg(11)->Unit(benchmark::kMicrosecond);

/// Aligns from a guess that is off by half a pixel.
void BM_AlignPatch(benchmark::State& state) {
  const BenchStreet& street = benchStreet(kWidth_px);
  const auto corners = innerCorners();
  std::vector<std::optional<PatchTemplate>> templates;
  for (const Corner& corner : corners)
    templates.push_back(makeTemplate(street.before->left.levels[0], corner.u_px, corner.v_px, kPatchWindow_px,
                                     PatchDeformation::kScale));
  std::size_t aligned = 0, tried = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (!templates[i]) continue;
      const Eigen::Vector2f guess_px(corners[i].u_px + 0.5F, corners[i].v_px - 0.4F);
      const auto patch = alignPatch(*templates[i], street.before->left.levels[0], guess_px, {});
      aligned += patch.has_value();
      ++tried;
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(tried));
  state.counters["aligned"] = static_cast<double>(aligned) / static_cast<double>(tried);
}
BENCHMARK(BM_AlignPatch)->Unit(benchmark::kMicrosecond);

/// Aligns from one frame to the next without a guess; the argument is the first level.
void BM_AlignCoarseToFine(benchmark::State& state) {
  const BenchStreet& street = benchStreet(kWidth_px);
  const auto corners = innerCorners();
  const auto first_level = static_cast<int>(state.range(0));
  std::size_t aligned = 0;
  for (auto _ : state) {
    for (const Corner& corner : corners) {
      const Eigen::Vector2f point_px(corner.u_px, corner.v_px);
      aligned += alignPatch(street.before->left, point_px, street.now->left, point_px, first_level, {}).has_value();
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(corners.size()));
  state.counters["aligned"] =
      static_cast<double>(aligned) / (static_cast<double>(state.iterations()) * static_cast<double>(corners.size()));
}
BENCHMARK(BM_AlignCoarseToFine)->Arg(1)->Arg(2)->Arg(3)->Unit(benchmark::kMicrosecond);

/// Refines around the true disparity; the argument is the radius of the search, which 0 leaves out.
void BM_RefineDisparity(benchmark::State& state) {
  const BenchStreet& street = benchStreet(kWidth_px);
  const auto corners = innerCorners();
  DisparityParams params;
  params.search_radius_px = static_cast<double>(state.range(0));
  for (auto _ : state) {
    for (const Corner& corner : corners) {
      const double truth_px = 8 + 60 * corner.v_px / street.camera.height_px;
      benchmark::DoNotOptimize(refineDisparity(street.before->left.levels[0], street.before->right.levels[0],
                                               corner.u_px, corner.v_px, truth_px, params));
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(corners.size()));
}
BENCHMARK(BM_RefineDisparity)->Arg(0)->Arg(3)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace motorcade::perf
