#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "io/inputs/pair_reader.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// JPEG quality that is sharp enough for a page.
inline constexpr int kPageJpegQuality = 78;

/// The left images of a sequence as JPEG, read on demand from any thread.
class SequencePictures {
 public:
  explicit SequencePictures(Sequence sequence) : sequence_(std::move(sequence)), reader_(sequence_) {}

  /// Null where there is no such frame, or its image cannot be read.
  std::shared_ptr<const std::string> jpeg(std::int64_t frame);

 private:
  Sequence sequence_;
  PairReader reader_;
  std::mutex one_at_a_time_;  // so that a page that scrubs takes one processor at most
};

}  // namespace motorcade
