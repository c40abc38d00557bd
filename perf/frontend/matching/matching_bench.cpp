#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "frontend/image/window_differences.hpp"
#include "frontend/matching/optical_flow.hpp"
#include "frontend/matching/stereo_matcher.hpp"
#include "perf/frontend/bench_street.hpp"

/// The searches of stereo matching, and the stages stereo and flow as a whole, on one thread.
namespace motorcade::perf {
namespace {

/// Items are pairs of windows.
void BM_WindowDifferences(benchmark::State& state) {
  const Features& features = *benchStreet(1242).now;
  const Image &left = features.left.levels[1], &right = features.right.levels[1];
  const WindowSize size = state.range(0) == 0 ? kFullSizeWindow : kHalfSizeWindow;
  std::vector<std::uint16_t> costs(state.range(1));
  int v = 20;
  for (auto _ : state) {
    windowDifferences({left, 300, v, size}, right, 120, v, costs);
    benchmark::DoNotOptimize(costs.data());
    v = v == 160 ? 20 : v + 1;
  }
  state.SetItemsProcessed(state.iterations() * state.range(1));
}
BENCHMARK(BM_WindowDifferences)->ArgNames({"half_size", "windows"})->Args({1, 96})->Args({0, 96})->Args({0, 7});

/// Items are corners.
void BM_MatchStereo(benchmark::State& state) {
  const BenchStreet& street = benchStreet(static_cast<int>(state.range(0)));
  const StereoMatcher match(StereoMatcher::Params{});
  onOneThread([&] {
    for (auto _ : state) benchmark::DoNotOptimize(match(street.now));
  });
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(street.now->corners.size()));
}
BENCHMARK(BM_MatchStereo)->Arg(621)->Arg(1242)->Unit(benchmark::kMicrosecond);

/// Renumbers the same features, as if the camera went to and fro between two positions.
FeaturesPtr renumbered(const Features& features, std::int64_t number) {
  auto frame = std::make_shared<StereoFrame>(*features.frame);
  frame->head.frame = {number};
  frame->head.stamp = {number * 100'000'000};
  auto copy = std::make_shared<Features>(features);
  copy->frame = std::move(frame);
  return copy;
}

/// Items are the points that were followed from the frame before.
void BM_TrackFlow(benchmark::State& state) {
  const BenchStreet& street = benchStreet(1242);
  OpticalFlowTracker::Params params;
  params.max_tracks = static_cast<int>(state.range(0));
  OpticalFlowTracker track(params);
  std::int64_t number = 0, followed = 0;
  onOneThread([&] {
    for (; number < 8; ++number) track(renumbered(number % 2 == 0 ? *street.before : *street.now, number));
    for (auto _ : state) {
      const auto flow = track(renumbered(number % 2 == 0 ? *street.before : *street.now, number));
      for (const FlowObservation& point : flow->observations) followed += point.age > 1;
      ++number;
    }
  });
  state.SetItemsProcessed(followed);
  state.counters["followed"] = static_cast<double>(followed) / static_cast<double>(state.iterations());
}
BENCHMARK(BM_TrackFlow)->Arg(250)->Arg(500)->Arg(1000)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace motorcade::perf
