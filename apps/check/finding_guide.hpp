#pragma once

#include <array>
#include <numbers>
#include <span>
#include <string>
#include <string_view>

#include "apps/watch/input_check.hpp"
#include "apps/watch/pair_geometry.hpp"

namespace motorcade {

/// Name, keys and shown unit of an error of the rows.
struct RowErrorName {
  const char* title;    // with the unit that it is shown in
  const char* key;      // in JSON, in the units of RowErrorEstimate
  const char* finding;  // the name of what is found where it is too large
  const char* meaning;  // of a positive value
  double unit = 1;      // shown value per value
};

/// Names in the order of RowError.
inline constexpr std::array<RowErrorName, kRowErrors> kRowErrorNames{{
    {"row offset [px]", "rows_px", "rows", "the right image's content lies lower"},
    {"roll [deg]", "roll_rad", "roll", "the right image is turned clockwise", 180 / std::numbers::pi},
    {"zoom [%]", "zoom", "zoom", "the right image is larger", 100},
    {"yaw [deg]", "yaw_rad", "yaw", "the right camera looks to the side", 180 / std::numbers::pi},
    {"lift / baseline", "lift", "lift", "the right camera stands higher"},
    {"ahead / baseline", "ahead", "ahead", "the right camera stands ahead"},
    {"distortion k1", "k1", "distortion", "both images are distorted like a cushion, below 0 like a barrel"},
}};

/// The meaning of a finding for results, and the user's remedy.
struct FindingGuide {
  std::string_view title, meaning, mend;
};

/// The guide by the finding's name; general words for one that has none of its own.
FindingGuide guideTo(std::string_view finding);

/// True when one of the findings makes results worthless.
bool isWorthless(std::span<const Finding> findings);

/// A sentence on what `run` does with these findings.
std::string verdictOnRun(std::span<const Finding> findings);

}  // namespace motorcade
