#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "frontend/geometry/delaunay.hpp"
#include "frontend/motion/ego_motion.hpp"
#include "frontend/motion/ground_plane.hpp"
#include "frontend/segmentation/motion_segmenter.hpp"
#include "tests/support/stereo_views.hpp"

/// Computations on points, without images. Items are points.
namespace motorcade::perf {
namespace {

constexpr int kVariants = 8;  // of each input, so that branches cannot be predicted from the iteration before

std::vector<Eigen::Vector2d> pixels(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1242), v(0, 375);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(u(random), v(random));
  return points;
}

template <class Work>
void measurePixels(benchmark::State& state, const Work& work) {
  std::vector<std::vector<Eigen::Vector2d>> sets;
  for (unsigned seed = 0; seed < kVariants; ++seed) sets.push_back(pixels(static_cast<int>(state.range(0)), seed));
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(work(sets[i++ % kVariants]));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void BM_Delaunay(benchmark::State& state) {
  measurePixels(state, [](const auto& points) { return delaunay(points); });
}
BENCHMARK(BM_Delaunay)->Arg(250)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);

void BM_CutDelaunayComponents(benchmark::State& state) {
  measurePixels(state, [](const auto& points) {
    return cutDelaunayComponents(points,
                                 [&points](int a, int b) { return (points[a] - points[b]).squaredNorm() < 400; });
  });
}
BENCHMARK(BM_CutDelaunayComponents)->Arg(250)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);

/// The second argument is the percentage of points that move relative to the world.
void BM_EgoMotion(benchmark::State& state) {
  const std::size_t count = state.range(0);
  const double moving = static_cast<double>(state.range(1)) / 100;
  const SE3 T_seen_now = SE3::exp((Vector6d() << 0.01, 0, 1.2, 0, 0.01, 0).finished());
  const SE3 T_now_seen = T_seen_now.inverse();
  std::vector<std::vector<PoseObservation>> frames(kVariants);
  for (unsigned seed = 0; seed < kVariants; ++seed) {
    test::Noise noise(seed + 1);
    while (frames[seed].size() < count) {
      const Eigen::Vector3d before = test::streetPoint(noise, 5, 50);
      const Eigen::Vector3d own = noise.uniform(0, 1) < moving ? Eigen::Vector3d(0.8, 0, 0) : Eigen::Vector3d(0, 0, 0);
      if (const auto seen = test::lookTwice(before, T_now_seen * (before + own), noise)) frames[seed].push_back(*seen);
    }
  }
  const EgoMotionEstimator estimate(EgoMotionEstimator::Params{}, test::kRig);
  const std::vector<PointLabel> labels(count);
  std::uint64_t number = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(estimate(frames[number % kVariants], labels,
                                      {.T_seen_now = T_seen_now, .dt_s = 0.1, .steady_frames = 5}, number));
    ++number;
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_EgoMotion)->Args({500, 0})->Args({1500, 0})->Args({1500, 30})->Unit(benchmark::kMicrosecond);

void BM_GroundPlane(benchmark::State& state) {
  test::Noise noise(3);
  std::vector<GroundCandidate> points;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    const double height_m = i % 3 == 0 ? noise.uniform(0, 2) : 0.03 * noise.uniform(-1, 1);
    points.push_back({{noise.uniform(-8, 8), 1.65 - height_m, noise.uniform(4, 30)}, 0.03});
  }
  GroundPlaneEstimator estimate(GroundPlaneEstimator::Params{});
  std::uint64_t number = 0;
  for (auto _ : state) benchmark::DoNotOptimize(estimate(points, number++));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_GroundPlane)->Arg(300)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace motorcade::perf
