#pragma once

#include <thread>

#include "apps/pipeline/pipeline.hpp"
#include "apps/run/camera_clock.hpp"
#include "io/sequence_decoder.hpp"

namespace motorcade {

/// Plays a decoded sequence into the pipeline on a thread of its own, then closes it. With a clock, each pair enters
/// when it is due; without, as soon as there is room.
class Feeder {
 public:
  /// `clock` may be null; it is started with the first pair. Only under the live policy may the decoder leave pairs
  /// out.
  Feeder(SequenceDecoder& decoder, Pipeline& pipeline, CameraClock* clock);
  ~Feeder() { stop(); }

  /// No further pair enters; from any thread.
  void stop();

 private:
  void feed(const std::stop_token& stopped);
  bool enter(StereoFrame frame);

  SequenceDecoder& decoder_;
  Pipeline& pipeline_;
  CameraClock* clock_;
  FrameId next_;  // after the last pair that entered
  std::jthread thread_;
};

}  // namespace motorcade
