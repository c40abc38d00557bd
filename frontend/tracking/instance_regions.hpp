#pragma once

#include <cstdint>
#include <vector>

#include "core/instance_labels.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Place of an instance label in the left image.
struct InstanceRegion {
  std::uint16_t label;
  Box box;
};

/// Upper part of a region, which of a person is trunk and head: legs swing.
Box upperPart(const Box& region);

/// Region of each label, ordered by label. Takes one look at each pixel.
std::vector<InstanceRegion> regionsOf(const InstanceLabels& labels);

}  // namespace motorcade
