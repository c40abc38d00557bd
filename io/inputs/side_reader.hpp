#pragma once

#include <exception>
#include <semaphore>
#include <thread>

#include "core/image.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Reads the images of one side on a thread of its own, while its owner reads those of the other.
class SideReader {
 public:
  /// `reader` and the frames must outlive any reading that was begun. `prepare` is called once, on the thread.
  SideReader(PairReader& reader, StereoSide side, void (*prepare)());
  ~SideReader();
  SideReader(const SideReader&) = delete;
  SideReader& operator=(const SideReader&) = delete;

  /// Begins to read an image. Each `begin` is followed by one `finish`, which waits for the image and rethrows the
  /// error of reading it.
  void begin(const FramePaths& frame);
  Image finish();

 private:
  void run(void (*prepare)());

  PairReader& reader_;
  StereoSide side_;
  const FramePaths* frame_ = nullptr;  // null: no further one
  Image image_;
  std::exception_ptr problem_;
  std::binary_semaphore begun_{0}, done_{0};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace motorcade
