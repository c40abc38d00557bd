#include "apps/evaluate/existence_json.hpp"

#include <utility>

#include <nlohmann/json.hpp>

namespace motorcade {

nlohmann::ordered_json jsonOf(const ExistenceErrors& errors) {
  using Json = nlohmann::ordered_json;
  Json tenths = Json::array();
  for (const ExistenceTenth& tenth : errors.tenths)
    tenths.push_back({{"rows", tenth.rows}, {"real", tenth.real}, {"probability_sum", tenth.probability_sum}});
  const auto gap = errors.largestGap();
  return {{"rows", errors.rows()},
          {"brier", errors.rows() > 0 ? Json(errors.brier()) : Json()},
          {"largest_gap", gap ? Json(*gap) : Json()},
          {"tenths", std::move(tenths)}};
}

}  // namespace motorcade
