#include "perf/backend/solver/far_covariances.hpp"

#include <array>
#include <random>

#include "core/thread_placement.hpp"

namespace motorcade::perf {
namespace {

constexpr int kPairs = 100;

}  // namespace

std::vector<double> farCovariances_ms(const PoseGraphFeed& feed, const PoseGraph& graph, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::size_t newest = graph.poses.size() - 1, apart = newest / 3;
  std::vector<double> all_ms;
  for (int pair = 0; pair < kPairs; ++pair) {
    const std::size_t a = pair == 0 ? 0 : std::uniform_int_distribution<std::size_t>(0, newest - apart)(random);
    const std::size_t b = pair == 0 ? newest : std::uniform_int_distribution<std::size_t>(a + apart, newest)(random);
    const auto first = feed.variableOf(graph.poses[a]), second = feed.variableOf(graph.poses[b]);
    if (!first || !second) continue;
    const double start_ms = threadCpu_ms();
    const auto covariance = feed.solver().jointCovariance(std::array{*first, *second});
    const double took_ms = threadCpu_ms() - start_ms;
    if (covariance) all_ms.push_back(took_ms);
  }
  return all_ms;
}

}  // namespace motorcade::perf
