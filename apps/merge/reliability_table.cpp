#include "apps/merge/reliability_table.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/report/reliability_json.hpp"
#include "apps/merge/result_tables.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

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

Json reliabilityJson(const Claim& claim, const ReliabilityBySet& sets) {
  Json json = Json::object();
  for (const auto& [set, of_set] : sets)
    json[set] = {{"final", jsonOf(of_set.final, claim.hits)}, {"online", jsonOf(of_set.online, claim.hits)}};
  return json;
}

}  // namespace motorcade
