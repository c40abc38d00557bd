#include "apps/watch/vehicle_motion_news.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>

namespace motorcade {
namespace {

constexpr int kMostSentences = 10;   // of a sensor that comes and goes
constexpr double kLooksAlike = 0.1;  // of a ratio

/// What may be wrong with a speed that the camera sees `ratio` times as large.
std::string guessAt(double ratio) {
  constexpr double kKilometersPerHour = 3.6, kMilesPerHour = 2.237, kFeetPerSecond = 3.281;
  const auto isNear = [&](double factor) { return std::abs(ratio * factor - 1) < kLooksAlike; };
  if (isNear(kKilometersPerHour)) return "; it looks like km/h, and m/s are expected";
  if (isNear(kMilesPerHour)) return "; it looks like mph, and m/s are expected";
  if (isNear(kFeetPerSecond)) return "; it looks like feet per second, and m/s are expected";
  if (std::abs(ratio + 1) < kLooksAlike) return "; its sign is the wrong way round";
  return "";
}

}  // namespace

std::optional<std::string> VehicleMotionNews::observe(const FrameMeasurements& frame) {
  const bool believed_before = !sensors_ || sensors_->believed;
  sensors_ = frame.vehicle_sensors;
  if (!sensors_) return std::nullopt;
  left_out_ += !sensors_->believed;
  if (sensors_->believed == believed_before || told_ >= kMostSentences) return std::nullopt;
  ++told_;
  std::ostringstream text;
  text << "frame " << frame.head.frame.value << ": ";
  if (sensors_->believed) {
    text << "the vehicle's own motion agrees with the camera again, and is used";
  } else {
    text << std::setprecision(2) << "the vehicle's own motion contradicts the camera, and is left out; the camera sees "
         << sensors_->speed_ratio << " times the speed that is told" << guessAt(sensors_->speed_ratio);
  }
  return text.str();
}

}  // namespace motorcade
