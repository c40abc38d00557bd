#include "apps/merge/batch_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "apps/merge/measures.hpp"

namespace motorcade {
namespace {

/// Twice the rank of each difference by its magnitude, so that shared ranks are whole numbers, too.
std::vector<std::size_t> doubledRanks(const std::vector<double>& differences) {
  std::vector<std::size_t> order(differences.size());
  std::iota(order.begin(), order.end(), 0);
  const auto magnitude = [&](std::size_t i) { return std::abs(differences[i]); };
  std::ranges::sort(order, {}, magnitude);
  std::vector<std::size_t> ranks(differences.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && magnitude(order[end]) == magnitude(order[begin])) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = begin + 1 + end;  // twice the mean of begin+1 .. end
    begin = end;
  }
  return ranks;
}

/// P(sum of the ranks with a positive sign <= `positive`), all signs being equally likely.
double exactTail(const std::vector<std::size_t>& ranks, std::size_t positive) {
  const std::size_t all = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<double> probability(all + 1, 0);  // of each sum so far
  probability[0] = 1;
  for (const std::size_t rank : ranks)
    for (std::size_t sum = all + 1; sum-- > 0;)
      probability[sum] = (probability[sum] + (sum >= rank ? probability[sum - rank] : 0)) / 2;
  return std::accumulate(probability.begin(), probability.begin() + static_cast<std::ptrdiff_t>(positive) + 1, 0.0);
}

/// The same by the normal distribution, with half a step (of doubled ranks: one) for continuity. The variance takes
/// shared ranks into account, as it is the sum of the ranks' squares.
double normalTail(const std::vector<std::size_t>& ranks, std::size_t positive) {
  double mean = 0, variance = 0;
  for (const std::size_t rank : ranks) {
    mean += static_cast<double>(rank) / 2;
    variance += static_cast<double>(rank * rank) / 4;
  }
  const double z = (static_cast<double>(positive) + 1 - mean) / std::sqrt(variance);
  return std::erfc(-z / std::numbers::sqrt2) / 2;
}

constexpr double kSignificant = 0.05;
constexpr std::string_view kBetter = "better", kWorse = "worse";  // verdicts that are sure
constexpr std::size_t kMostRegressions = 40;                      // of the table; the JSON file has all

/// The measures that are compared. They are few, as each more makes the test less sharp.
constexpr std::array<std::string_view, 16> kAccuracy{"camera_ate_m",
                                                     "camera_rpe_t_rmse_m",
                                                     "camera_rpe_r_rmse_deg",
                                                     "me_t_m",
                                                     "me_r_deg",
                                                     "speed_error_mps",
                                                     "objects_as_seen_m",
                                                     "recall_30m",
                                                     "recall_30_to_50m",
                                                     "false_rows",
                                                     "id_switches",
                                                     "hota",
                                                     "box_iou_2d",
                                                     "box_iou_bird",
                                                     "mask_iou",
                                                     "tracked_fraction"};
constexpr std::array<std::string_view, 4> kCost{"latency_p50_ms", "latency_p99_ms", "cpu_per_frame_ms",
                                                "peak_memory_mb"};

using SeedValues = std::map<std::string, const MeasureValues*>;  // by drive, seed and set

SeedValues valuesBySeed(const std::vector<ResultGroup>& groups, bool with_sets) {
  SeedValues values;
  for (const ResultGroup& group : groups)
    for (const auto& seed : group.seeds()) {
      std::string name = group.drive();
      if (seed.seed) name += fmt::format("-{}", *seed.seed);
      values[with_sets ? name + "." + group.set() : name] = &seed.values;
    }
  return values;
}

/// One result in both batches.
struct Pair {
  std::string name;
  const MeasureValues *before, *now;
};

bool differs(double a, double b) { return !std::isnan(a) && !std::isnan(b) && a != b; }

/// Pairs the seeds of both batches. Those that only one of them has are named.
std::vector<Pair> pairsOf(const SeedValues& ours, const SeedValues& others, std::vector<std::string>& unpaired) {
  std::vector<Pair> pairs;
  for (const auto& [name, values] : ours) {
    const auto other = others.find(name);
    if (other == others.end())
      unpaired.push_back(name + " (not in the other batch)");
    else if (const std::size_t frames = measureIndex("frames"); differs((*values)[frames], (*other->second)[frames]))
      unpaired.push_back(name + " (other frames were run)");
    else
      pairs.push_back({name, other->second, values});
  }
  for (const auto& [name, values] : others)
    if (!ours.contains(name)) unpaired.push_back(name + " (only in the other batch)");
  return pairs;
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

MeasureComparison compare(std::string_view measure, const std::vector<Pair>& pairs) {
  const std::size_t index = measureIndex(measure);
  const bool lower_is_better = allMeasures()[index].better == Better::kLower;
  MeasureComparison comparison{.measure = measure};
  std::vector<double> changes;
  for (const Pair& pair : pairs) {
    const double before = (*pair.before)[index], now = (*pair.now)[index];
    if (std::isnan(before) || std::isnan(now)) continue;
    changes.push_back(relativeChange(before, now));
    if (changes.back() != 0) ++((changes.back() < 0) == lower_is_better ? comparison.better : comparison.worse);
  }
  comparison.pairs = changes.size();
  comparison.median_change = medianOf(changes);
  comparison.p = signedRankTest(changes);
  return comparison;
}

std::string verdictOn(const MeasureComparison& comparison) {
  const std::size_t different = comparison.better + comparison.worse;
  if (different == 0) return "the same";
  if (different < kFewestDifferences) return fmt::format("{} pairs differ, too few to tell", different);
  if (comparison.corrected_p >= kSignificant) return "no difference that is sure";
  return std::string(comparison.better > comparison.worse ? kBetter : kWorse);
}

/// Corrects for the number of tests. A measure of which too few pairs differ cannot be significant, and so is no test.
void correctForNumber(std::vector<MeasureComparison>& measures) {
  std::vector<MeasureComparison*> tested;
  std::vector<double> p_values;
  for (MeasureComparison& measure : measures) {
    if (measure.better + measure.worse < kFewestDifferences) continue;
    tested.push_back(&measure);
    p_values.push_back(measure.p);
  }
  const auto corrected = holmCorrected(p_values);
  for (std::size_t i = 0; i < tested.size(); ++i) tested[i]->corrected_p = corrected[i];
}

void addRegressions(BatchComparison& comparison, std::string_view measure, const std::vector<Pair>& pairs) {
  const std::size_t index = measureIndex(measure);
  const bool lower_is_better = allMeasures()[index].better == Better::kLower;
  for (const Pair& pair : pairs) {
    const double before = (*pair.before)[index], now = (*pair.now)[index];
    if (std::isnan(before) || std::isnan(now)) continue;
    const double change = relativeChange(before, now);
    if ((lower_is_better ? change : -change) > kWorthTelling)
      comparison.regressions.push_back({pair.name, measure, before, now, change});
  }
}

}  // namespace

double signedRankTest(const std::vector<double>& differences) {
  std::vector<double> nonzero = differences;
  std::erase(nonzero, 0.0);
  if (nonzero.empty()) return 1;
  const auto ranks = doubledRanks(nonzero);
  std::size_t positive = 0, negative = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) (nonzero[i] > 0 ? positive : negative) += ranks[i];
  const std::size_t smaller = std::min(positive, negative);
  const double tail = ranks.size() <= kMostExact ? exactTail(ranks, smaller) : normalTail(ranks, smaller);
  return std::min(1.0, 2 * tail);
}

std::vector<double> holmCorrected(const std::vector<double>& p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<double> corrected(p_values.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - i) * p_values[order[i]]));
    corrected[order[i]] = largest;
  }
  return corrected;
}

double relativeChange(double before, double now) {
  const double mean = (std::abs(before) + std::abs(now)) / 2;
  return mean > 0 ? (now - before) / mean : 0;
}

BatchComparison compareBatches(const std::vector<ResultGroup>& ours, const std::vector<ResultGroup>& others,
                               const std::filesystem::path& against) {
  BatchComparison comparison{.against = against};
  const bool with_sets = setsIn(ours) > 1 || setsIn(others) > 1;
  const auto pairs = pairsOf(valuesBySeed(ours, with_sets), valuesBySeed(others, with_sets), comparison.unpaired);
  for (const std::string_view measure : kAccuracy) {
    comparison.measures.push_back(compare(measure, pairs));
    addRegressions(comparison, measure, pairs);
  }
  for (const std::string_view measure : kCost) comparison.measures.push_back(compare(measure, pairs));
  std::erase_if(comparison.measures, [](const MeasureComparison& measure) { return measure.pairs == 0; });
  correctForNumber(comparison.measures);
  for (MeasureComparison& measure : comparison.measures) measure.verdict = verdictOn(measure);
  std::ranges::stable_sort(comparison.regressions, std::greater(),
                           [](const Regression& regression) { return std::abs(regression.change); });
  return comparison;
}

ResultTable testTable(const BatchComparison& comparison) {
  ResultTable table{.title = "Against " + comparison.against.string(),
                    .heads = {"measure", "verdict", "pairs", "better", "worse", "median change", "p", "p, corrected"},
                    .names = 2};
  for (const auto& m : comparison.measures) {
    const Tone tone = m.verdict == kBetter ? Tone::kBetter : m.verdict == kWorse ? Tone::kWorse : Tone::kNone;
    table.tones.push_back({Tone::kNone, tone, Tone::kNone, Tone::kNone, Tone::kNone, tone});
    table.rows.push_back({readableName(m.measure), m.verdict, std::to_string(m.pairs), std::to_string(m.better),
                          std::to_string(m.worse), fmt::format("{:+.1f} %", 100 * m.median_change), numberText(m.p, 4),
                          numberText(m.corrected_p, 4)});
  }
  return table;
}

ResultTable regressionTable(const BatchComparison& comparison) {
  ResultTable table{.title = fmt::format("Worse by more than {:.0f} %", 100 * kWorthTelling),
                    .heads = {"result", "measure", "before", "now", "times"},
                    .names = 2};
  for (std::size_t i = 0; i < std::min(kMostRegressions, comparison.regressions.size()); ++i) {
    const Regression& regression = comparison.regressions[i];
    const double ratio = regression.before != 0 ? regression.now / regression.before : kNoValue;
    table.rows.push_back({regression.result, readableName(regression.measure), fmt::format("{:.4g}", regression.before),
                          fmt::format("{:.4g}", regression.now), numberText(ratio, 3)});
    table.tones.push_back({Tone::kNone, Tone::kNone, Tone::kNone, Tone::kWorse, Tone::kWorse});
  }
  if (comparison.regressions.size() > kMostRegressions)
    table.title += fmt::format(", the first {} of {}", kMostRegressions, comparison.regressions.size());
  return table;
}

}  // namespace motorcade
