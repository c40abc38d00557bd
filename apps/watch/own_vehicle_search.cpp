#include "apps/watch/own_vehicle_search.hpp"

#include <memory>

namespace motorcade {

void OwnVehicleSearch::observe(const StereoFrame& pair) {
  const FeaturesPtr features = prepare_(std::make_shared<const StereoFrame>(pair));
  found_ = segment_(match_(features), follow_(features))->own_vehicle;
}

}  // namespace motorcade
