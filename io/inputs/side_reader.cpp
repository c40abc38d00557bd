#include "io/inputs/side_reader.hpp"

#include <utility>

namespace motorcade {

SideReader::SideReader(PairReader& reader, StereoSide side, void (*prepare)())
    : reader_(reader), side_(side), thread_([this, prepare] { run(prepare); }) {}

SideReader::~SideReader() {
  frame_ = nullptr;
  begun_.release();
}

void SideReader::begin(const FramePaths& frame) {
  frame_ = &frame;
  begun_.release();
}

Image SideReader::finish() {
  done_.acquire();
  if (problem_) std::rethrow_exception(std::exchange(problem_, nullptr));
  return std::exchange(image_, Image());
}

void SideReader::run(void (*prepare)()) {
  prepare();
  for (begun_.acquire(); frame_; begun_.acquire()) {
    try {
      image_ = reader_.read(*frame_, side_);
    } catch (...) {
      problem_ = std::current_exception();
    }
    done_.release();
  }
}

}  // namespace motorcade
