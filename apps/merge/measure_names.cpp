#include "apps/merge/measure_names.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>
#include <vector>

namespace motorcade {
namespace {

using Entry = std::pair<std::string_view, std::string_view>;

/// Endings of keys and the units that they stand for.
constexpr std::array kUnits{Entry{"_deg_per_m", "deg/m"}, Entry{"_percent", "%"}, Entry{"_radps2", "rad/s2"},
                            Entry{"_mps2", "m/s2"},       Entry{"_mps", "m/s"},   Entry{"_deg", "deg"},
                            Entry{"_px", "px"},           Entry{"_ms", "ms"},     Entry{"_hz", "Hz"},
                            Entry{"_mb", "MB"},           Entry{"_m", "m"},       Entry{"_s", "s"},
                            Entry{"_frames", "frames"}};

/// Parts of keys and their meanings; longer parts come first.
constexpr std::array kParts{Entry{"first_report", "frames until first reported"},
                            Entry{"origin_drift", "drift of the origin"},
                            Entry{"offset_removed", "offset removed"},
                            Entry{"30_to_50m", "from 30 to 50 m"},
                            Entry{"as_seen", "as seen from the camera"},
                            Entry{"iou_bird", "IoU from above"},
                            Entry{"hota_above", "HOTA from above"},
                            Entry{"id_switches", "switches of identity"},
                            Entry{"false_rows", "false rows"},
                            Entry{"over_half", "share of IoU over 0.5"},
                            Entry{"end_error", "error at the end"},
                            Entry{"kinds_right", "kinds right"},
                            Entry{"kinds_log_loss", "log loss of kinds"},
                            Entry{"kinds_sure_wrong", "kinds wrong and sure"},
                            Entry{"box_length_in_2_sigma", "share of lengths within two standard deviations"},
                            Entry{"box_width_in_2_sigma", "share of widths within two standard deviations"},
                            Entry{"box_height_in_2_sigma", "share of heights within two standard deviations"},
                            Entry{"box_heading", "error of boxes' heading"},
                            Entry{"box_center", "error of boxes' center"},
                            Entry{"box_length", "error of boxes' length"},
                            Entry{"box_height", "error of boxes' height"},
                            Entry{"box_width", "error of boxes' width"},
                            Entry{"mask_boundary", "distance of masks' boundaries"},
                            Entry{"peak_memory", "most memory"},
                            Entry{"throughput", "pairs per second"},
                            Entry{"existence_brier", "Brier score of existence"},
                            Entry{"tracked_fraction", "share of frames tracked"},
                            Entry{"per_frame", "per pair"},
                            Entry{"never_reported", "movers never reported"},
                            Entry{"mounted", "without the truth's mounting"},
                            Entry{"rpe_t", "RPE of translation"},
                            Entry{"rpe_r", "RPE of rotation"},
                            Entry{"me_t", "motion error of objects, translation"},
                            Entry{"me_r", "motion error of objects, rotation"},
                            Entry{"det_a", "DetA"},
                            Entry{"ass_a", "AssA"},
                            Entry{"loc_a", "LocA"},
                            Entry{"re", "relative improvement on the baseline"},
                            Entry{"path", "length of the path"},
                            Entry{"wall", "wall time"},
                            Entry{"30m", "to 30 m"},
                            Entry{"50m", "to 50 m"},
                            Entry{"hota", "HOTA"},
                            Entry{"mota", "MOTA"},
                            Entry{"nees", "NEES"},
                            Entry{"rmse", "RMSE"},
                            Entry{"rms", "RMS"},
                            Entry{"kitti", "KITTI"},
                            Entry{"iou", "IoU"},
                            Entry{"ate", "ATE"},
                            Entry{"are", "ARE"},
                            Entry{"cpu", "CPU"},
                            Entry{"p50", "median"},
                            Entry{"p95", "95th percentile"},
                            Entry{"p99", "99th percentile"},
                            Entry{"max", "largest"},
                            Entry{"2d", "in the image"},
                            Entry{"3d", "in 3D"}};

/// Tells whether a comma follows the part in a name: it does after a statistic and after a range of distances.
bool closesName(std::string_view part) {
  constexpr std::array<std::string_view, 10> kSummaries{
      "RMSE",    "RMS",     "median",  "mean",           "95th percentile", "99th percentile",
      "largest", "to 30 m", "to 50 m", "from 30 to 50 m"};
  return std::ranges::find(kSummaries, part) != std::end(kSummaries);
}

/// Cuts the first part off; an unknown word stands for itself.
std::string_view takePart(std::string_view& key) {
  for (const auto& [part, meaning] : kParts) {
    if (!key.starts_with(part) || (key.size() > part.size() && key[part.size()] != '_')) continue;
    key.remove_prefix(std::min(key.size(), part.size() + 1));
    return meaning;
  }
  const std::string_view word = key.substr(0, key.find('_'));
  key.remove_prefix(std::min(key.size(), word.size() + 1));
  return word;
}

}  // namespace

std::string readableName(std::string_view measure) {
  std::string_view key = measure, unit;
  for (const auto& [end, name] : kUnits)
    if (unit.empty() && key.ends_with(end)) {
      unit = name;
      key.remove_suffix(end.size());
    }
  const bool online = key.starts_with("online_");
  if (online) key.remove_prefix(std::string_view("online_").size());
  std::string name;
  while (!key.empty()) {
    const std::string_view part = takePart(key);
    if (!name.empty()) name += closesName(part) ? ", " : " ";
    name += part;
  }
  if (online) name += ", online";
  return unit.empty() ? name : name.append(" [").append(unit).append("]");
}

}  // namespace motorcade
