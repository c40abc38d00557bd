#include "apps/merge/existence_table.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/existence_json.hpp"
#include "apps/merge/result_tables.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kTenths = std::tuple_size_v<decltype(ExistenceErrors::tenths)>;
using Estimates = std::array<std::pair<const char*, const ExistenceErrors*>, 2>;

Estimates estimatesOf(const ExistenceOfSet& of_set) { return {{{"final", &of_set.final}, {"online", &of_set.online}}}; }

void add(ExistenceErrors& sums, const nlohmann::json& counted) {
  if (counted.at("rows") == 0) return;
  const auto& tenths = counted.at("tenths");
  for (std::size_t i = 0; i < std::min(kTenths, tenths.size()); ++i) {
    sums.tenths[i].rows += tenths[i].at("rows").get<int>();
    sums.tenths[i].real += tenths[i].at("real").get<int>();
    sums.tenths[i].probability_sum += tenths[i].at("probability_sum").get<double>();
  }
  sums.squared_error_sum += counted.at("brier").get<double>() * counted.at("rows").get<int>();
}

std::array<bool, kTenths> tenthsWithRows(const ExistenceBySet& sets) {
  std::array<bool, kTenths> with_rows{};
  for (const auto& [set, of_set] : sets)
    for (const auto& [name, errors] : estimatesOf(of_set))
      for (std::size_t i = 0; i < kTenths; ++i) with_rows[i] = with_rows[i] || errors->tenths[i].rows > 0;
  return with_rows;
}

std::string textOf(const ExistenceTenth& tenth) {
  if (tenth.rows == 0) return "-";
  return fmt::format("{} of {} ({})", numberText(tenth.shareReal(), 2), numberText(tenth.claimed(), 2), tenth.rows);
}

}  // namespace

void addExistence(ExistenceOfSet& sums, const nlohmann::json& evaluation) {
  for (const auto& [name, errors] : {std::pair("final", &sums.final), std::pair("online", &sums.online)})
    if (evaluation.contains(name) && evaluation.at(name).contains("existence"))
      add(*errors, evaluation.at(name).at("existence"));
}

ResultTable existenceTable(const ExistenceBySet& sets) {
  const auto with_rows = tenthsWithRows(sets);
  ResultTable table{.title = "Existence: share that is real of what is claimed (rows), by tenths of the probability",
                    .heads = {"set", "estimate", "rows", "Brier", "largest gap"},
                    .names = 2};
  for (std::size_t i = 0; i < kTenths; ++i)
    if (with_rows[i]) table.heads.push_back(fmt::format("{:.1f} to {:.1f}", 0.1 * i, 0.1 * (i + 1)));
  for (const auto& [set, of_set] : sets)
    for (const auto& [name, errors] : estimatesOf(of_set)) {
      if (errors->rows() == 0) continue;
      std::vector<std::string> row{set, name, std::to_string(errors->rows()), numberText(errors->brier(), 3),
                                   numberText(errors->largestGap().value_or(kNoValue), 2)};
      for (std::size_t i = 0; i < kTenths; ++i)
        if (with_rows[i]) row.push_back(textOf(errors->tenths[i]));
      table.rows.push_back(std::move(row));
    }
  return table;
}

Json existenceJson(const ExistenceBySet& sets) {
  Json json = Json::object();
  for (const auto& [set, of_set] : sets)
    json[set] = {{"final", jsonOf(of_set.final)}, {"online", jsonOf(of_set.online)}};
  return json;
}

}  // namespace motorcade
