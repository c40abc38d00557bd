#include <benchmark/benchmark.h>

#include "frontend/features/corner_detector.hpp"
#include "frontend/features/feature_preparation.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "perf/frontend/bench_street.hpp"

/// Preparation of an image: pyramids and corners. Items are pixels of the full-size image.
namespace motorcade::perf {
namespace {

void reportPixels(benchmark::State& state, const Image& image) {
  state.SetItemsProcessed(state.iterations() * image.width() * image.height());
}

void BM_Halved(benchmark::State& state) {
  const Image& image = benchStreet(static_cast<int>(state.range(0))).now->frame->left;
  ImagePool pool;
  for (auto _ : state) benchmark::DoNotOptimize(halved(image, pool));
  reportPixels(state, image);
}
BENCHMARK(BM_Halved)->Arg(621)->Arg(1242);

void BM_BuildPyramid(benchmark::State& state) {
  const Image& image = benchStreet(static_cast<int>(state.range(0))).now->frame->left;
  ImagePool pool;
  for (auto _ : state) benchmark::DoNotOptimize(buildPyramid(image, 4, pool));
  reportPixels(state, image);
}
BENCHMARK(BM_BuildPyramid)->Arg(621)->Arg(1242);

void BM_DetectCorners(benchmark::State& state) {
  const Image& image = benchStreet(static_cast<int>(state.range(0))).now->frame->left;
  const CornerDetector detect(CornerDetector::Params{});
  for (auto _ : state) benchmark::DoNotOptimize(detect(image));
  reportPixels(state, image);
}
BENCHMARK(BM_DetectCorners)->Arg(621)->Arg(1242)->Unit(benchmark::kMicrosecond);

/// The whole stage: both images.
void BM_PreparePair(benchmark::State& state) {
  const StereoFramePtr& frame = benchStreet(static_cast<int>(state.range(0))).now->frame;
  const FeaturePreparation prepare(FeaturePreparation::Params{});
  onOneThread([&] {
    for (auto _ : state) benchmark::DoNotOptimize(prepare(frame));
  });
  reportPixels(state, frame->left);
}
BENCHMARK(BM_PreparePair)->Arg(621)->Arg(1242)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace motorcade::perf
