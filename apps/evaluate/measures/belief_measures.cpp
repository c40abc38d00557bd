#include "apps/evaluate/measures/belief_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace motorcade {
namespace {

constexpr int kLeastRows = 100;  // of a tenth that is judged: the share's own deviation is .05 at most

/// Types of KITTI's labels, and those that rendered scenes add.
constexpr std::array<std::pair<std::string_view, ObjectKind>, 13> kTypes = {{
    {"Car", ObjectKind::kCar},
    {"Van", ObjectKind::kCar},
    {"Truck", ObjectKind::kLargeVehicle},
    {"Bus", ObjectKind::kLargeVehicle},
    {"Tram", ObjectKind::kLargeVehicle},
    {"Trailer", ObjectKind::kLargeVehicle},
    {"Cyclist", ObjectKind::kTwoWheeler},
    {"Bicycle", ObjectKind::kTwoWheeler},
    {"Motorbike", ObjectKind::kTwoWheeler},
    {"Motorcyclist", ObjectKind::kTwoWheeler},
    {"Pedestrian", ObjectKind::kPedestrian},
    {"Person", ObjectKind::kPedestrian},
    {"Person_sitting", ObjectKind::kPedestrian},
}};

}  // namespace

void Reliability::add(double probability, bool hit) {
  const auto at = std::min<std::size_t>(tenths.size() - 1, static_cast<std::size_t>(10 * probability));
  ReliabilityTenth& tenth = tenths[at];
  ++tenth.rows;
  tenth.hits += hit;
  tenth.probability_sum += probability;
  const double error = probability - (hit ? 1 : 0);
  squared_error_sum += error * error;
}

int Reliability::rows() const {
  int sum = 0;
  for (const ReliabilityTenth& tenth : tenths) sum += tenth.rows;
  return sum;
}

double Reliability::brier() const { return squared_error_sum / std::max(1, rows()); }

std::optional<double> Reliability::largestGap() const {
  std::optional<double> largest;
  for (const ReliabilityTenth& tenth : tenths)
    if (tenth.rows >= kLeastRows)
      largest = std::max(largest.value_or(0), std::abs(tenth.claimed() - tenth.shareOfHits()));
  return largest;
}

Reliability existenceErrors(const std::vector<ComparedFrame>& frames) {
  Reliability errors;
  for (const ComparedFrame& frame : frames)
    for (const MatchedRow& row : frame.rows)
      if (!row.in_ignored_area)
        errors.add(row.row.object.existence_probability, row.object >= 0 && frame.objects[row.object].ever_moves);
  return errors;
}

ObjectKind kindOfType(std::string_view type) {
  const auto* const found = std::ranges::find(kTypes, type, &decltype(kTypes)::value_type::first);
  return found == kTypes.end() ? ObjectKind::kUnknown : found->second;
}

int KindCounts::total() const {
  int sum = 0;
  for (const auto& of_label : rows)
    for (const int count : of_label) sum += count;
  return sum;
}

double KindCounts::shareRight() const {
  int right = 0;
  for (const ObjectKind kind : kAllKinds) right += of(kind, kind);
  return right / std::max(1.0, static_cast<double>(total()));
}

void KindRows::add(ObjectKind label, ObjectKind reported, double probability) {
  constexpr double kSure = 0.95, kHalfDecimal = 0.0005;
  ++counts.rows[static_cast<std::size_t>(label)][static_cast<std::size_t>(reported)];
  if (reported == ObjectKind::kUnknown) {
    log_loss_sum += std::numbers::ln2;
    return;
  }
  const bool right = reported == label;
  const double of_outcome = right ? probability : 1 - probability;
  log_loss_sum -= std::log(std::clamp(of_outcome, kHalfDecimal, 1 - kHalfDecimal));
  sure_wrong += !right && probability >= kSure;
  named.add(probability, right);
}

double KindRows::logLoss() const { return log_loss_sum / std::max(1, counts.total()); }

double KindRows::shareSureWrong() const { return sure_wrong / std::max(1.0, static_cast<double>(counts.total())); }

KindErrors kindErrors(const std::vector<ComparedFrame>& frames, double to_m) {
  const auto rows_before = rowsBefore(frames);
  KindErrors errors;
  for (const auto& [frame, object, row] : askedPairs(frames, 0, to_m)) {
    const ObjectKind label = kindOfType(object->truth.type);
    if (label == ObjectKind::kUnknown) continue;
    const auto& cuboid = row->row.object.cuboid;
    KindRows& rows = rows_before.at(row) >= kEarlyRows ? errors.from_tenth_row : errors.before;
    rows.add(label, cuboid ? cuboid->kind : ObjectKind::kUnknown, cuboid ? cuboid->kind_probability : 0);
  }
  return errors;
}

}  // namespace motorcade
