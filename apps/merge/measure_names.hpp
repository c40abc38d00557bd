#pragma once

#include <string>
#include <string_view>

namespace motorcade {

/// The name of a measure (`allMeasures`) for readers, with its unit in brackets: `camera_rpe_t_rmse_m` is "camera RPE
/// of translation, RMSE [m]". It is made of the key's words, so that a new measure has one, too.
std::string readableName(std::string_view measure);

}  // namespace motorcade
