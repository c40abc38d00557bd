#include "apps/merge/reliability_tables.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/report/report.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/merge/result_tables.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kTenths = std::tuple_size_v<decltype(Reliability::tenths)>;
using Estimates = std::array<std::pair<const char*, const Reliability*>, 2>;

Estimates estimatesOf(const ReliabilityOfSet& of_set) {
  return {{{"final", &of_set.final}, {"online", &of_set.online}}};
}

void add(Reliability& sums, const char* hits, const nlohmann::json& counted) {
  if (counted.at("rows") == 0) return;
  const auto& tenths = counted.at("tenths");
  for (std::size_t i = 0; i < std::min(kTenths, tenths.size()); ++i) {
    sums.tenths[i].rows += tenths[i].at("rows").get<int>();
    sums.tenths[i].hits += tenths[i].at(hits).get<int>();
    sums.tenths[i].probability_sum += tenths[i].at("probability_sum").get<double>();
  }
  sums.squared_error_sum += counted.at("brier").get<double>() * counted.at("rows").get<int>();
}

std::array<bool, kTenths> tenthsWithRows(const ReliabilityBySet& sets) {
  std::array<bool, kTenths> with_rows{};
  for (const auto& [set, of_set] : sets)
    for (const auto& [name, counts] : estimatesOf(of_set))
      for (std::size_t i = 0; i < kTenths; ++i) with_rows[i] = with_rows[i] || counts->tenths[i].rows > 0;
  return with_rows;
}

std::string textOf(const ReliabilityTenth& tenth) {
  if (tenth.rows == 0) return "-";
  return fmt::format("{} of {} ({})", numberText(tenth.shareOfHits(), 2), numberText(tenth.claimed(), 2), tenth.rows);
}

constexpr std::array kAxisTitles = {"x", "y", "z", "about x", "about y", "about z"};
static_assert(kAxisTitles.size() == AxisReliability::kAxes);
constexpr std::array kToldTenths = {5, 8, 9};

/// The keys of each title's covariances in an evaluation; the first that is there counts.
constexpr std::array<std::array<const char*, 2>, kCovarianceTitles.size()> kKeys = {
    {{"camera_mounted_with_truth_noise", "camera"}, {"camera_since_start", ""}, {"objects", ""}}};

void addTo(CovarianceReliability& sums, const nlohmann::json& covariances) {
  for (std::size_t i = 0; i < sums.size(); ++i)
    for (const char* key : kKeys[i]) {
      const auto found = covariances.find(key);
      if (found == covariances.end() || !found->is_object() || !found->contains("by_axis")) continue;
      sums[i].add(axisReliabilityOf(found->at("by_axis")));
      break;
    }
}

/// Calls `take` with the set's name, the estimate's, the title, and the counts, unless there are none.
template <class Take>
void forEach(const CovarianceReliabilityBySet& sets, const Take& take) {
  for (const auto& [set, of_set] : sets)
    for (const auto& [estimate, sums] : {std::pair("final", &of_set.final), std::pair("online", &of_set.online)})
      for (std::size_t i = 0; i < sums->size(); ++i)
        if ((*sums)[i].samples() > 0) take(set, estimate, kCovarianceTitles[i], (*sums)[i]);
}

std::vector<ChartLine> linesOf(const AxisReliability& counts) {
  std::vector<ChartLine> lines{
      {.name = "claimed", .color = "var(--truth)", .points = {{0, 0}, {100, 100}}, .dashed = true}};
  for (int axis = 0; axis < AxisReliability::kAxes; ++axis) {
    ChartLine line{.name = kAxisTitles[axis], .color = fmt::format("var(--s{})", axis + 1)};
    for (int tenths = 0; tenths <= AxisReliability::kTenths; ++tenths)
      line.points.emplace_back(10.0 * tenths, 100 * counts.shareWithin(axis, tenths));
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

void addReliability(ReliabilityOfSet& sums, const Claim& claim, const nlohmann::json& evaluation) {
  const nlohmann::json::json_pointer pointer{std::string(claim.path)};
  for (const auto& [name, counts] : {std::pair("final", &sums.final), std::pair("online", &sums.online)})
    if (evaluation.contains(name) && evaluation.at(name).contains(pointer))
      add(*counts, claim.hits, evaluation.at(name).at(pointer));
}

ResultTable reliabilityTable(const Claim& claim, const ReliabilityBySet& sets) {
  const auto with_rows = tenthsWithRows(sets);
  ResultTable table{.title = std::string(claim.title) + " of what is claimed (rows), by tenths of the probability",
                    .heads = {"set", "estimate", "rows", "Brier", "largest gap"},
                    .names = 2};
  for (std::size_t i = 0; i < kTenths; ++i)
    if (with_rows[i]) table.heads.push_back(fmt::format("{:.1f} to {:.1f}", 0.1 * i, 0.1 * (i + 1)));
  for (const auto& [set, of_set] : sets)
    for (const auto& [name, counts] : estimatesOf(of_set)) {
      if (counts->rows() == 0) continue;
      std::vector<std::string> row{set, name, std::to_string(counts->rows()), numberText(counts->brier(), 3),
                                   numberText(counts->largestGap().value_or(kNoValue), 2)};
      for (std::size_t i = 0; i < kTenths; ++i)
        if (with_rows[i]) row.push_back(textOf(counts->tenths[i]));
      table.rows.push_back(std::move(row));
    }
  return table;
}

nlohmann::ordered_json reliabilityJson(const Claim& claim, const ReliabilityBySet& sets) {
  auto json = nlohmann::ordered_json::object();
  for (const auto& [set, of_set] : sets)
    json[set] = {{"final", jsonOf(of_set.final, claim.hits)}, {"online", jsonOf(of_set.online, claim.hits)}};
  return json;
}

void addCovariances(CovarianceReliabilityOfSet& sums, const nlohmann::json& evaluation) {
  const auto covariances = evaluation.find("covariance");
  if (covariances == evaluation.end()) return;
  addTo(sums.online, *covariances);
  if (covariances->contains("final")) addTo(sums.final, covariances->at("final"));
}

ResultTable covarianceTable(const CovarianceReliabilityBySet& sets) {
  ResultTable table{
      .title = "Covariances: share of errors within the intervals that are claimed to hold 50 / 80 / 90 % of them",
      .heads = {"set", "estimate", "of", "errors"},
      .names = 3};
  table.heads.insert(table.heads.end(), kAxisTitles.begin(), kAxisTitles.end());
  forEach(sets, [&](const std::string& set, const char* estimate, const char* title, const AxisReliability& counts) {
    std::vector<std::string> row{set, estimate, title, std::to_string(counts.samples())};
    for (int axis = 0; axis < AxisReliability::kAxes; ++axis) {
      std::vector<std::string> shares;
      for (const int tenths : kToldTenths)
        shares.push_back(fmt::format("{:.0f}", 100 * counts.shareWithin(axis, tenths)));
      row.push_back(fmt::format("{} %", fmt::join(shares, " / ")));
    }
    table.rows.push_back(std::move(row));
  });
  return table;
}

nlohmann::ordered_json covarianceJson(const CovarianceReliabilityBySet& sets) {
  auto json = nlohmann::ordered_json::object();
  forEach(sets, [&](const std::string& set, const char* estimate, const char* title, const AxisReliability& counts) {
    json[set][estimate][title] = jsonOf(counts);
  });
  return json;
}

std::string covarianceCharts(const CovarianceReliabilityBySet& sets) {
  std::string charts;
  forEach(sets, [&](const std::string& set, const char* estimate, const char* title, const AxisReliability& counts) {
    const std::string svg = lineChart({.x = "claimed, %", .y = "found, %"}, linesOf(counts));
    charts += chartFigure(svg, fmt::format("{}, {}: {} ({} errors). Below the dashed line claims are too sure.", set,
                                           estimate, title, counts.samples()));
  });
  return charts.empty() ? "" : "<div class=\"grid\">\n" + charts + "</div>\n";
}

}  // namespace motorcade
