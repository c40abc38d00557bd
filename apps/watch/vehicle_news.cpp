#include "apps/watch/vehicle_news.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>

namespace motorcade {
namespace {

constexpr double kGrowth_s = 2;

constexpr int kMostSentences = 10;    // of a sensor that comes and goes
constexpr double kLooksAlike = 0.05;  // of a ratio

/// A guess at the fault of the vehicle's motion, as the end of a sentence.
std::string guessAt(const VehicleSensors& sensors) {
  constexpr double kKilometersPerHour = 3.6, kMilesPerHour = 2.237, kFeetPerSecond = 3.281, kDegreesPerRadian = 57.3;
  const auto isTimes = [](double told, double seen, double factor) {
    return std::abs(told - factor * seen) < kLooksAlike * std::abs(factor * seen);
  };
  const double told_mps = sensors.told.speed_mps, seen_mps = sensors.seen.speed_mps;
  if (isTimes(told_mps, seen_mps, kKilometersPerHour)) return ": it looks like km/h, and m/s are expected";
  if (isTimes(told_mps, seen_mps, kMilesPerHour)) return ": it looks like mph, and m/s are expected";
  if (isTimes(told_mps, seen_mps, kFeetPerSecond)) return ": it looks like feet per second, and m/s are expected";
  if (isTimes(told_mps, seen_mps, -1)) return ": its sign is the wrong way round; speeds are positive ahead";
  if (isTimes(sensors.told.yaw_rate_radps, sensors.seen.yaw_rate_radps, kDegreesPerRadian))
    return ": the yaw rate looks like deg/s, and rad/s are expected";
  if (isTimes(sensors.told.yaw_rate_radps, sensors.seen.yaw_rate_radps, -1))
    return ": the yaw rate's sign is the wrong way round; it is positive to the left";
  return "";
}

std::string textOf(const VehicleSensors::Motion& motion) {
  std::ostringstream text;
  text << std::setprecision(3) << motion.speed_mps << " m/s and " << motion.yaw_rate_radps << " rad/s";
  return text.str();
}

}  // namespace

std::string placeOf(const OwnVehicleView& view) {
  const auto number = [](double value) { return std::to_string(std::lround(value)); };
  return "fills " + number(100 * view.share) + " % of the left image (columns " + number(view.box.left_px) + " to " +
         number(view.box.right_px) + ", rows " + number(view.box.top_px) + " to " + number(view.box.bottom_px) + ")";
}

std::optional<std::string> OwnVehicleNews::observe(const FrameMeasurements& frame) {
  if (!frame.own_vehicle) return std::nullopt;
  view_ = frame.own_vehicle;
  if (!found_) found_ = frame.head.stamp;
  if (secondsBetween(*found_, frame.head.stamp) < kGrowth_s) return std::nullopt;
  return finish();
}

std::optional<std::string> OwnVehicleNews::finish() {
  if (!view_ || told_) return std::nullopt;
  told_ = true;
  return "the own vehicle " + placeOf(*view_) + ": nothing is followed there";
}

std::optional<std::string> VehicleMotionNews::observe(const FrameMeasurements& frame) {
  const bool believed_before = !sensors_ || sensors_->believed;
  sensors_ = frame.vehicle_sensors;
  if (!sensors_) return std::nullopt;
  left_out_ += !sensors_->believed;
  if (sensors_->believed == believed_before || told_ >= kMostSentences) return std::nullopt;
  ++told_;
  const std::string when = "frame " + std::to_string(frame.head.frame.value) + ": the vehicle's own motion ";
  if (sensors_->believed) return when + "agrees with the camera again, and is used";
  return when + "contradicts the camera, and is left out; " + textOf(sensors_->told) +
         " are told where the camera sees " + textOf(sensors_->seen) + guessAt(*sensors_);
}

}  // namespace motorcade
