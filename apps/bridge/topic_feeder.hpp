#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "apps/bridge/dds/image_subscriber.hpp"
#include "apps/bridge/input_watch.hpp"
#include "apps/bridge/messages/pair_conversion.hpp"
#include "io/messages/stamp_pairing.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Pairs two topics' images and pushes them into a tracker, with the left image's stamp. First `awaitCameras`, then
/// `feed`; `counts` and `problem` are for any thread.
class TopicFeeder {
 public:
  struct Params {
    CameraKnowledge cameras{};  // without infos
    std::int64_t tolerance_ns = 5'000'000;
    std::int64_t most_pairs = 0;  // then it ends; 0: there is no end
    bool every_pair = false;      // else the newest one replaces those that were not converted yet
  };
  TopicFeeder(ImageSubscriber& images, const Params& params);

  /// Works until the cameras are known and a pair has come, or until `patience` is over. Returns whether both are so.
  /// Throws InputError where the calibration is of no use.
  bool awaitCameras(std::chrono::milliseconds patience);
  /// The camera of the rectified pairs.
  const Sequence& cameras() const { return *cameras_; }
  /// Pushes until asked to stop, or until all pairs have come; then closes the tracker.
  void feed(Tracker& tracker, const std::stop_token& stop);

  InputCounts counts() const;
  std::string problem() const;

 private:
  using Clock = InputWatch::Clock;

  void takeInfos();
  void takeMotions(Tracker& tracker);
  /// Takes one image from the side on which fewer wait for a partner; false where there is none.
  bool takeImage();
  /// Takes images up to the next pair if none may be lost, else all that came. False where there is nothing to do.
  bool takeImages();
  void keep(ReceivedPair pair);
  void tell(const InputWatch::News& news) const;
  void tellState();
  void tellMissingInfos(Clock::time_point now);
  void knowCameras();
  void push(Tracker& tracker, PairConversion& conversion, const ReceivedPair& pair);
  void refuse(const std::string& why);
  bool hasAll() const { return params_.most_pairs > 0 && counts_.pairs >= params_.most_pairs; }

  ImageSubscriber& images_;
  Params params_;
  Clock::time_point start_ = Clock::now();
  StampPairing<ReceivedImage> pairing_;
  InputWatch watch_;
  std::deque<ReceivedPair> pairs_;  // that wait to be pushed
  std::optional<Sequence> cameras_{};
  bool told_infos_ = false, told_motion_ = false;
  Clock::time_point next_complaint_{};

  InputCounts counts_{};
  mutable std::mutex mutex_;  // of the two below
  InputCounts told_counts_{};
  std::string told_problem_{};
};

}  // namespace motorcade
