#include "apps/watch/own_vehicle_news.hpp"

#include <cmath>

namespace motorcade {
namespace {

constexpr double kGrowth_s = 2;

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

}  // namespace motorcade
