#pragma once

#include <memory>
#include <vector>

#include "core/vehicle_motion.hpp"
#include "io/inputs/pair_source.hpp"

namespace motorcade {

/// The pairs of another source, each with the samples of the vehicle's own motion up to its time, as sensors would have
/// sent them during the drive.
class VehicleMotionSource final : public PairSource {
 public:
  /// `samples` are ordered by time.
  VehicleMotionSource(std::unique_ptr<PairSource> pairs, std::vector<VehicleMotionSample> samples);

  std::optional<StereoFrame> next() override;
  void stop() override { pairs_->stop(); }
  SourceEnd finish() override { return pairs_->finish(); }

  FrameId first() const override { return pairs_->first(); }
  Timestamp stampOf(FrameId frame) const override { return pairs_->stampOf(frame); }
  double shareOutside() const override { return pairs_->shareOutside(); }
  std::size_t highWater() const override { return pairs_->highWater(); }
  std::size_t capacity() const override { return pairs_->capacity(); }

 private:
  std::unique_ptr<PairSource> pairs_;
  std::vector<VehicleMotionSample> samples_;
  std::size_t next_ = 0;  // of the samples
  std::shared_ptr<VehicleMotionLog> log_;
};

}  // namespace motorcade
