#include "io/inputs/sequence_decoder.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include <sys/resource.h>

namespace motorcade {
namespace {

/// Lowers the priority, so that decoding ahead gives way to the frame that is due, but is not starved by other
/// programs. At the lowest priority, 19, it gets hundredths of a busy processor, and the drive falls seconds behind. On
/// Linux the priority is the calling thread's alone. Without it all works as well, only later.
void giveWay() {
  constexpr int kLessUrgent = 5;
  setpriority(PRIO_PROCESS, 0, kLessUrgent);
}

template <class Work>
std::exception_ptr problemOf(const Work& work) {
  try {
    work();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace

SequenceDecoder::SequenceDecoder(Sequence sequence, FrameRange range, const Params& params)
    : sequence_(std::move(sequence)),
      wanted_(params.wanted),
      inputs_(params.inputs),
      range_(range.within(sequence_.frames.size())),
      reader_(sequence_, params.max_file_mb),
      right_(reader_, StereoSide::kRight, giveWay),
      ring_(params.ahead) {
  thread_ = std::jthread([this] {
    giveWay();
    for (std::size_t index = range_.begin; index < range_.end; ++index) {
      if (!wants(index)) continue;
      letThePairGoAhead();
      if (ring_.closed() || !ring_.push(decode(index))) return;
    }
    ring_.close();
  });
}

SequenceDecoder::~SequenceDecoder() { ring_.close(); }

SourceEnd SequenceDecoder::finish() {
  ring_.close();
  thread_.join();
  return {};
}

/// Reads both images. If neither can be read, throws the error of the left one.
void SequenceDecoder::readInto(StereoFrame& frame, const FramePaths& paths) {
  right_.begin(paths);
  const std::exception_ptr left = problemOf([&] { frame.left = reader_.read(paths, StereoSide::kLeft); });
  const std::exception_ptr right = problemOf([&] { frame.right = right_.finish(); });
  if (left || right) std::rethrow_exception(left ? left : right);
}

std::optional<StereoFrame> SequenceDecoder::next() {
  auto frame = ring_.pop();
  taken_.store(std::chrono::steady_clock::now().time_since_epoch().count(), std::memory_order_relaxed);
  return frame;
}

/// Waits while a pair that was just taken is worked on. As long as there are pairs enough, the next one is decoded
/// afterwards.
void SequenceDecoder::letThePairGoAhead() const {
  constexpr std::chrono::milliseconds kWork(25), kPause(2);
  const auto enough = [this] { return 2 * ring_.size() >= ring_.capacity(); };
  const auto taken = [this] { return SteadyTime(SteadyTime::duration(taken_.load(std::memory_order_relaxed))); };
  ring_.waitForRoom();
  while (!ring_.closed() && enough() && std::chrono::steady_clock::now() < taken() + kWork)
    std::this_thread::sleep_for(kPause);
}

StereoFrame SequenceDecoder::decode(std::size_t index) {
  const auto start = std::chrono::steady_clock::now();
  StereoFrame frame;
  frame.head = {.frame = {static_cast<std::int64_t>(index)}, .stamp = sequence_.stamps[index]};
  frame.inputs = inputs_;
  try {
    readInto(frame, sequence_.frames[index]);
  } catch (const std::exception& error) {  // nothing may leave the thread: also a lack of memory only costs the frame
    frame.reject(FrameCause::kUnusable, error.what());
  }
  frame.decoded = std::chrono::steady_clock::now();
  frame.decode_ms = std::chrono::duration<double, std::milli>(frame.decoded - start).count();
  return frame;
}

}  // namespace motorcade
