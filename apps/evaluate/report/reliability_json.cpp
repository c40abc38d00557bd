#include "apps/evaluate/report/reliability_json.hpp"

#include <utility>

#include <nlohmann/json.hpp>

namespace motorcade {

nlohmann::ordered_json jsonOf(const Reliability& reliability, const char* hits) {
  using Json = nlohmann::ordered_json;
  Json tenths = Json::array();
  for (const ReliabilityTenth& tenth : reliability.tenths)
    tenths.push_back({{"rows", tenth.rows}, {hits, tenth.hits}, {"probability_sum", tenth.probability_sum}});
  const auto gap = reliability.largestGap();
  return {{"rows", reliability.rows()},
          {"brier", reliability.rows() > 0 ? Json(reliability.brier()) : Json()},
          {"largest_gap", gap ? Json(*gap) : Json()},
          {"tenths", std::move(tenths)}};
}

}  // namespace motorcade
