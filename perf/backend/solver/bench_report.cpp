#include "perf/backend/solver/bench_report.hpp"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "perf/backend/solver/batch_reference.hpp"

namespace motorcade::perf {
namespace {

using Json = nlohmann::ordered_json;

double mebibytes(std::size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

void printTimes(const char* what, const Quantiles& ms) {
  std::printf("  %-28s total %.3f s, median %.3f ms, p99 %.3f ms, max %.3f ms\n", what, 1e-3 * ms.total, ms.median,
              ms.p99, ms.max);
}

/// The part of a run before the first loop closure, and the part from there on.
struct AroundClosure {
  Quantiles before_ms, after_ms;
};
AroundClosure aroundClosure(const GraphFigures& figures) {
  const std::span<const double> all(figures.run.cpu_ms);
  const std::size_t first = figures.closures->first_update;
  return {quantilesOf(all.first(first)), quantilesOf(all.subspan(first))};
}

void printClosures(const GraphFigures& figures) {
  const auto& closures = *figures.closures;
  const auto [before_ms, after_ms] = aroundClosure(figures);
  printTimes("before the first closure:", before_ms);
  printTimes("from it on:", after_ms);
  std::printf("  %-28s ", "chi2 within 0.1 %:");
  if (closures.updates_until_settled)
    std::printf("%zu updates after the first closure", *closures.updates_until_settled);
  else
    std::printf("never after the first closure");
  std::printf("; above in %zu of %zu updates, by %.4f %% at most\n", closures.unsettled_updates,
              figures.run.cpu_ms.size() - closures.first_update, closures.worst_excess_percent);
}

void printSettling(const GraphRun& run) {
  const Quantiles ms = quantilesOf(run.settling->cpu_ms);
  std::printf("  %-28s %zu further updates, max %.3f ms; chi2 %.7g, %.4f %% above the optimum\n",
              "until nothing waits:", run.settling->cpu_ms.size(), ms.max, run.settling->chi2,
              excessPercent(run.settling->chi2, run.optimum));
}

template <class Item, class Value>
double worst(const std::vector<Item>& items, Value Item::*value) {
  double worst = 0;
  for (const Item& item : items) worst = std::max(worst, item.*value);
  return worst;
}

void printCheck(const SolutionCheck& check) {
  std::printf("  %-28s chi2 at most %.4f %% above it, newest pose at most %.4f sigmas off; %s\n",
              "beside batch solutions:", worst(check.chi2, &SolutionCheck::Chi2::excess_percent),
              worst(check.pose, &SolutionCheck::Pose::sigmas), check.failures.empty() ? "good" : "FAILED");
  for (const auto& failure : check.failures) std::printf("    %s\n", failure.c_str());
}

Json jsonOf(const Quantiles& quantiles) {
  return {{"total", quantiles.total}, {"median", quantiles.median}, {"p99", quantiles.p99}, {"max", quantiles.max}};
}

Json closuresJson(const GraphFigures& figures) {
  const auto& closures = *figures.closures;
  const auto [before_ms, after_ms] = aroundClosure(figures);
  Json json = {
      {"first_update", closures.first_update}, {"before_ms", jsonOf(before_ms)}, {"after_ms", jsonOf(after_ms)}};
  json["updates_until_settled"] = closures.updates_until_settled ? Json(*closures.updates_until_settled) : Json();
  json["unsettled_updates"] = closures.unsettled_updates;
  json["worst_excess_percent"] = closures.worst_excess_percent;
  return json;
}

Json jsonOf(const SolutionCheck& check) {
  Json json = {
      {"good", check.failures.empty()}, {"failures", check.failures}, {"chi2", Json::array()}, {"pose", Json::array()}};
  for (const auto& [updates, excess] : check.chi2)
    json["chi2"].push_back({{"updates", updates}, {"excess_percent", excess}});
  for (const auto& [updates, sigmas] : check.pose) json["pose"].push_back({{"updates", updates}, {"sigmas", sigmas}});
  return json;
}

Json jsonOf(const MultibodyBin& bin) {
  return {{"frame", bin.frame},
          {"update_ms", jsonOf(bin.update_ms)},
          {"retire_ms", jsonOf(bin.retire_ms)},
          {"eliminated_scalars", jsonOf(bin.eliminated_scalars)},
          {"substituted_scalars", jsonOf(bin.substituted_scalars)},
          {"normalized_error", bin.normalized_error},
          {"variables", bin.variables},
          {"factors", bin.factors},
          {"held_bytes", bin.held_bytes},
          {"heap_bytes", bin.heap_bytes},
          {"resident_bytes", bin.resident_bytes}};
}

Json jsonOf(const MultibodyAging& aging) {
  return {{"old_ms", aging.old_ms},
          {"young_ms", aging.young_ms},
          {"time_ratio", aging.timeRatio()},
          {"old_scalars", aging.old_scalars},
          {"young_scalars", aging.young_scalars}};
}

Json jsonOf(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

void printAging(const MultibodyAging& aging, int frames) {
  std::printf(
      "  beside a solver that begins after %d frames: median %.3f ms, the young one's %.3f ms, ratio %.3f (scalars "
      "%.0f, %.0f)%s\n",
      frames, aging.old_ms, aging.young_ms, aging.timeRatio(), aging.old_scalars, aging.young_scalars,
      aging.timeRatio() <= MultibodyAging::kMaxRatio ? "" : ": FAILED, it grows");
}

void printBin(const MultibodyRun& run, const MultibodyBin& bin) {
  const int frames = run.options.window_frames > 0 ? std::min(bin.frame, run.options.window_frames) : bin.frame;
  std::printf("%8d %9.3f %8.3f %8.3f %9.3f %7.0f %7.0f %7.0f %7.0f %9zu %8.2f %9.1f %8.2f %8.2f %7.2f\n", bin.frame,
              bin.update_ms.median, bin.update_ms.p99, bin.update_ms.max, bin.retire_ms.median,
              bin.eliminated_scalars.median, bin.eliminated_scalars.p99, bin.substituted_scalars.median,
              bin.substituted_scalars.p99, bin.variables, mebibytes(bin.held_bytes),
              1024 * mebibytes(bin.held_bytes) / frames, mebibytes(bin.heap_bytes), mebibytes(bin.resident_bytes),
              bin.normalized_error);
}

}  // namespace

void printGraphHead() {
  std::printf("%-20s %6s %6s %8s %9s %8s %8s %12s %12s %8s %7s %7s %7s %7s %7s %7s %8s\n", "graph", "poses", "edges",
              "total s", "median ms", "p99 ms", "max ms", "chi2", "optimum", "excess %", "elim.", "median", "p99",
              "subst.", "median", "p99", "held MiB");
}

void printGraph(const GraphFigures& figures) {
  const GraphRun& run = figures.run;
  const Quantiles ms = quantilesOf(run.cpu_ms), eliminated = quantilesOf(run.eliminated_scalars),
                  substituted = quantilesOf(run.substituted_scalars);
  const auto updates = static_cast<double>(std::max<std::size_t>(1, run.cpu_ms.size()));
  std::printf(
      "%-20s %6zu %6zu %8.3f %9.3f %8.3f %8.3f %12.7g %12.7g %8.4f %7.0f %7.0f %7.0f %7.0f %7.0f %7.0f %8.2f%s\n",
      figures.name.c_str(), run.poses, run.edges, 1e-3 * ms.total, ms.median, ms.p99, ms.max, run.chi2, run.optimum,
      excessPercent(run.chi2, run.optimum), eliminated.total / updates, eliminated.median, eliminated.p99,
      substituted.total / updates, substituted.median, substituted.p99, mebibytes(run.held_bytes),
      run.reached_from_odometry ? "" : "  (optimum not reached from odometry)");
  printTimes("covariance of two far poses:", quantilesOf(run.far_covariances_ms));
  if (run.problems > 0) std::printf("  %zu problems reported\n", run.problems);
  if (run.settling) printSettling(run);
  if (figures.closures) printClosures(figures);
  if (figures.check) printCheck(*figures.check);
  std::fflush(stdout);
}

Json jsonOf(const GraphFigures& figures) {
  const GraphRun& run = figures.run;
  Json json = {{"name", figures.name},
               {"poses", run.poses},
               {"edges", run.edges},
               {"updates", run.cpu_ms.size()},
               {"problems", run.problems},
               {"cpu_ms", jsonOf(quantilesOf(run.cpu_ms))},
               {"eliminated_scalars", jsonOf(quantilesOf(run.eliminated_scalars))},
               {"substituted_scalars", jsonOf(quantilesOf(run.substituted_scalars))},
               {"chi2", run.chi2},
               {"optimum", run.optimum},
               {"excess_percent", excessPercent(run.chi2, run.optimum)},
               {"reached_from_odometry", run.reached_from_odometry},
               {"far_covariances_ms", jsonOf(quantilesOf(run.far_covariances_ms))},
               {"held_bytes", run.held_bytes}};
  if (run.settling)
    json["settling"] = {{"updates", run.settling->cpu_ms.size()},
                        {"cpu_ms", jsonOf(quantilesOf(run.settling->cpu_ms))},
                        {"chi2", run.settling->chi2}};
  if (figures.closures) json["closures"] = closuresJson(figures);
  if (figures.check) json["check"] = jsonOf(*figures.check);
  return json;
}

void printMultibody(const MultibodyRun& run) {
  std::printf("\n%d objects in view, %d frames, window %d, seed %llu: total %.3f s, max %.3f ms\n", run.options.objects,
              run.options.frames, run.options.window_frames, static_cast<unsigned long long>(run.options.seed),
              1e-3 * run.update_ms.total, run.update_ms.max);
  std::printf("%8s %9s %8s %8s %9s %7s %7s %7s %7s %9s %8s %9s %8s %8s %7s\n", "around", "update ms", "p99", "max",
              "retire ms", "elim.", "p99", "subst.", "p99", "variables", "held MiB", "KiB/frame", "heap MiB", "RSS MiB",
              "error^2");
  for (const MultibodyBin& bin : run.bins) printBin(run, bin);
  if (const auto growth = run.timeGrowth())
    std::printf("  median of the last row over that of the first: %.3f\n", *growth);
  if (run.aging) printAging(*run.aging, run.options.frames);
  std::printf("  chi2 at the end is %.4f %% above what Gauss-Newton reaches from there\n", run.chi2_excess_percent);
  if (run.problems > 0) std::printf("  %zu problems reported\n", run.problems);
  std::fflush(stdout);
}

Json jsonOf(const MultibodyRun& run) {
  Json json = {{"objects", run.options.objects},
               {"frames", run.options.frames},
               {"window_frames", run.options.window_frames},
               {"seed", run.options.seed},
               {"update_ms", jsonOf(run.update_ms)},
               {"time_growth", jsonOf(run.timeGrowth())},
               {"aging", run.aging ? jsonOf(*run.aging) : Json()},
               {"chi2_excess_percent", run.chi2_excess_percent},
               {"problems", run.problems},
               {"bins", Json::array()}};
  for (const MultibodyBin& bin : run.bins) json["bins"].push_back(jsonOf(bin));
  return json;
}

}  // namespace motorcade::perf
