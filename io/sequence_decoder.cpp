#include "io/sequence_decoder.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include <sys/resource.h>

namespace motorcade {
namespace {

/// Decoding ahead gives way to the frame that is due, but not so far that other programs starve it: at the lowest
/// priority, 19, it gets hundredths of a busy processor, and the drive falls seconds behind. On Linux the priority is
/// the calling thread's alone; without it all works as well, only later.
void giveWay() {
  constexpr int kLessUrgent = 5;
  setpriority(PRIO_PROCESS, 0, kLessUrgent);
}

}  // namespace

SequenceDecoder::SequenceDecoder(Sequence sequence, FrameRange range, const Params& params)
    : sequence_(std::move(sequence)),
      wanted_(params.wanted),
      range_(range.within(sequence_.frames.size())),
      reader_(sequence_, params.max_file_mb),
      ring_(params.ahead) {
  thread_ = std::jthread([this] {
    giveWay();
    for (std::size_t index = range_.begin; index < range_.end; ++index) {
      if (!wants(index)) continue;
      if (ring_.closed() || !ring_.push(decode(index))) return;
    }
    ring_.close();
  });
}

SequenceDecoder::~SequenceDecoder() { ring_.close(); }

StereoFrame SequenceDecoder::decode(std::size_t index) {
  const auto start = std::chrono::steady_clock::now();
  StereoFrame frame;
  frame.frame.value = static_cast<std::int64_t>(index);
  frame.stamp = sequence_.stamps[index];
  try {
    frame.left = reader_.read(sequence_.frames[index], StereoSide::kLeft);
    frame.right = reader_.read(sequence_.frames[index], StereoSide::kRight);
  } catch (const std::exception& error) {  // nothing may leave the thread: also a lack of memory only costs the frame
    frame.left = frame.right = Image();
    frame.problem = error.what();
  }
  frame.decoded = std::chrono::steady_clock::now();
  frame.decode_ms = std::chrono::duration<double, std::milli>(frame.decoded - start).count();
  return frame;
}

}  // namespace motorcade
