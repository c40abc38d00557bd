#pragma once

#include <optional>
#include <string>

#include "core/messages.hpp"

namespace motorcade {

/// "fills 19 % of the left image (columns 0 to 1241, rows 304 to 374)", as a sentence goes on after its subject.
std::string placeOf(const OwnVehicleView& view);

/// Tells once what was found of the own vehicle: two seconds after its first part, in which it grows.
class OwnVehicleNews {
 public:
  /// Takes the frames in order. A sentence when there is something to tell.
  std::optional<std::string> observe(const FrameMeasurements& frame);
  /// No further frame comes: what was not told yet.
  std::optional<std::string> finish();

  /// The latest view of the own vehicle; empty while none was found.
  const std::optional<OwnVehicleView>& view() const { return view_; }

 private:
  std::optional<Timestamp> found_;
  std::optional<OwnVehicleView> view_;
  bool told_ = false;
};

}  // namespace motorcade
