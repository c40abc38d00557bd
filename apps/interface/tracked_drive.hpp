#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "apps/interface/camera_model.hpp"
#include "apps/interface/final_taker.hpp"
#include "apps/interface/pair_input.hpp"
#include "apps/interface/pair_numbers.hpp"
#include "apps/interface/pair_watch.hpp"
#include "apps/interface/result_conversion.hpp"
#include "apps/interface/result_queue.hpp"
#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "apps/watch/vehicle_news.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// One drive of a tracker: all that is forgotten when the tracker is reset. A thread of its own takes the pipeline's
/// results, converts and delivers them, and calls the callback for finals.
class TrackedDrive {
 public:
  /// The parts that it shares with the tracker, which outlives it.
  struct Surroundings {
    const PipelineConfig& config;
    const CameraModel& model;
    const LogCallback& log;
    std::atomic_flag& pushing;  // held by the thread that pushes
    ResultQueue& results;
    FinalTaker& finals;
  };
  TrackedDrive(const Surroundings& around, const ResultConversion& convert);
  /// Abandons what is in flight.
  ~TrackedDrive();
  TrackedDrive(const TrackedDrive&) = delete;
  TrackedDrive& operator=(const TrackedDrive&) = delete;

  /// Starts to deliver results. Its objects have ids from `first_id` on.
  void start(std::int64_t first_id);

  /// The bits of this pair's samples; called by the pushing thread.
  int sampleBitsOf(const Pair& pair) { return sample_bits_.of(pair); }
  /// The pushing thread.
  Tracker::Push push(StereoFrame frame);
  Tracker::Push pushMotion(const VehicleMotion& motion) noexcept;
  void close();
  /// Stops delivery and ends every wait.
  void abandon();
  /// True on the thread that delivers, as within a callback for finals.
  bool delivers() const { return std::this_thread::get_id() == deliverer_.get_id(); }
  /// Waits until the delivering thread has ended. Returns the first id that no object of this or an earlier drive has.
  std::int64_t end();

 private:
  void deliver();
  void deliverAll();
  void deliverOne(const PipelineResult& result);
  void deliverFinals(const std::vector<FrameEstimate>& finals);
  std::vector<FrameEstimate> lastFinals();
  const char* whyNot(Admission admission) const;

  Surroundings around_;
  std::shared_ptr<VehicleMotionLog> vehicle_motion_ = std::make_shared<VehicleMotionLog>();
  SampleBits sample_bits_;
  PairNumbers numbers_;
  StampDoubts stamp_doubts_;  // the pushing thread's
  std::atomic<bool> closed_{false}, failed_{false}, abandoned_{false};
  ResultConversion convert_;  // the delivering thread's, as the news and the watch
  OwnVehicleNews own_vehicle_news_;
  VehicleMotionNews vehicle_motion_news_;
  PairWatch watch_;
  Pipeline pipeline_;
  std::jthread deliverer_;
};

}  // namespace motorcade
