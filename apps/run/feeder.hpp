#pragma once

#include <optional>
#include <thread>

#include "apps/pipeline/pipeline.hpp"
#include "io/sequence_decoder.hpp"

namespace motorcade {

/// Plays a decoded sequence into the pipeline on a thread of its own, then closes it. With a pace, each pair is due at
/// start + (stamp - first stamp) / pace and enters then; without, as soon as there is room.
class Feeder {
 public:
  /// `pace` is the number of captured seconds per second of replay.
  Feeder(SequenceDecoder& decoder, Pipeline& pipeline, std::optional<double> pace);
  ~Feeder() { stop(); }

  /// No further pair enters; from any thread.
  void stop();

 private:
  void feed(const std::stop_token& stopped);

  SequenceDecoder& decoder_;
  Pipeline& pipeline_;
  std::optional<double> pace_;
  std::jthread thread_;
};

}  // namespace motorcade
