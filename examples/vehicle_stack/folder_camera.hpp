#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <motorcade/motorcade.hpp>

namespace vehicle_stack {

/// Stands in for the camera's driver: a recorded drive, decoded into memory, whose pairs come at a fixed rate.
///
/// To be replaced by a class with the same two calls: `camera` says what the pairs are, and `next` waits for a pair.
class FolderCamera {
 public:
  enum class Stamps {
    kKept,    // the recording's, so that velocities are right at any rate
    kRemade,  // one period apart, for recordings whose times mean nothing
  };
  struct Params {
    double rate_hz = 30;
    int loops = 1;
    std::int64_t most_pairs = 300;  // of the drive; each takes twice its pixels in bytes
    Stamps stamps = Stamps::kKept;
    double stall_at_s = 0, stall_for_s = 0;  // what is captured meanwhile is lost, as in a real camera
  };

  /// Reads the whole drive; between pairs it asks whether to give up. Throws motorcade::Error.
  FolderCamera(const std::string& folder, const Params& params, const std::function<bool()>& give_up);

  const motorcade::Camera& camera() const { return camera_; }
  /// Waits for the next pair, whose pixels live as long as this camera. Empty at the end, and soon after a request to
  /// stop.
  std::optional<motorcade::Pair> next(const std::stop_token& stop);

  /// The pair that is captured in a tick of the camera's clock, from 0 on.
  motorcade::Pair pairOf(std::int64_t tick) const;
  bool stalledIn(std::int64_t tick) const;
  std::int64_t ticks() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    std::vector<std::uint8_t> left, right;  // empty where an image could not be read
    std::int64_t stamp_ns;
  };

  motorcade::Pair::Image view(const std::vector<std::uint8_t>& pixels) const;
  std::int64_t stampOf_ns(std::int64_t tick) const;

  Params params_;
  motorcade::Camera camera_;
  std::vector<Frame> frames_;
  std::int64_t period_ns_;
  std::int64_t next_tick_ = 0;
  std::optional<Clock::time_point> start_;
};

}  // namespace vehicle_stack
