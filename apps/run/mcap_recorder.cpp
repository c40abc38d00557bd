#include "apps/run/mcap_recorder.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace motorcade {
namespace {

/// Frames that wait for their result, and results that wait to be written. Those with images span a fraction of a
/// second, those without some seconds, when a disk stalls.
constexpr std::size_t kMostImages = 32, kMostWaitingWithImage = 8, kMostWaiting = 64;
/// Longest wait for a pair's announcement. It comes just after the pair has entered. Its result may overtake it by as
/// much as the system delays a thread.
constexpr auto kAnnouncement = std::chrono::seconds(1);

}  // namespace

McapRecorder::McapRecorder(const std::filesystem::path& file, const StereoCamera& camera, Behind behind)
    : out_(file, camera),
      camera_(camera),
      behind_(behind),
      thread_([this](const std::stop_token& stopped) { writeAll(stopped); }) {}

McapRecorder::~McapRecorder() {
  thread_.request_stop();
  changed_.notify_all();
}

void McapRecorder::frameEntered(const StereoFrame& frame) {
  {
    const std::lock_guard lock(mutex_);
    if (!frame.left.empty() && images_.size() < kMostImages) images_[frame.head.frame] = frame.left;
    last_entered_ = frame.head.frame;
  }
  changed_.notify_all();
}

void McapRecorder::frameLeft(const PipelineResult& result) {
  std::unique_lock lock(mutex_);
  if (behind_ == Behind::kWait)
    changed_.wait(lock, [&] { return waiting_.size() < kMostWaitingWithImage || failure_; });
  throwFailure();
  if (waiting_.size() < kMostWaiting)
    enqueue(result);
  else
    ++left_out_.frames;
  lock.unlock();
  changed_.notify_all();
}

/// Whoever calls holds the mutex.
void McapRecorder::enqueue(const PipelineResult& result) {
  const auto with_image = std::ranges::count(waiting_, true, &Waiting::with_image);
  waiting_.push_back({.estimate = result.online,
                      .measurements = result.measurements,
                      .timing = result.timing,
                      .with_image = std::cmp_less(with_image, kMostWaitingWithImage)});
}

void McapRecorder::close() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  throwFailure();
  out_.close();
}

void McapRecorder::throwFailure() {
  if (failure_) std::rethrow_exception(failure_);
}

void McapRecorder::writeAll(const std::stop_token& stopped) {
  try {
    while (const auto waiting = next(stopped)) out_.write(exported(*waiting));
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  changed_.notify_all();
}

/// The next frame to write; empty at the end.
std::optional<McapRecorder::Waiting> McapRecorder::next(const std::stop_token& stopped) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stopped, [&] { return !waiting_.empty() || ending_; });
  if (stopped.stop_requested() || waiting_.empty()) return {};
  Waiting waiting = std::move(waiting_.front());
  waiting_.pop_front();
  lock.unlock();
  changed_.notify_all();
  return waiting;
}

/// Image of a frame whose result has left. Earlier frames will not be asked for any more.
Image McapRecorder::imageOf(FrameId frame) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kAnnouncement, [&] { return last_entered_ >= frame; });
  images_.erase(images_.begin(), images_.lower_bound(frame));
  auto found = images_.extract(frame);
  return found ? std::move(found.mapped()) : Image();
}

ExportedFrame McapRecorder::exported(const Waiting& waiting) {
  ExportedFrame frame;
  frame.estimate = waiting.estimate;
  frame.stages = stageTimes(waiting.timing);
  frame.latency_ms = waiting.timing.latency_ms();
  frame.decode_ms = waiting.timing.decode_ms;
  if (waiting.measurements) {
    frame.points = exportedPoints(*waiting.measurements, camera_);
    frame.points_at_rest = static_cast<int>(waiting.measurements->at_rest.size());
    frame.points_undecided = static_cast<int>(waiting.measurements->undecided.size());
  }
  const Image left = imageOf(waiting.estimate.head.frame);
  if (waiting.with_image && !left.empty()) frame.jpeg = exportedImage(left);
  const std::lock_guard lock(mutex_);
  if (frame.jpeg.empty() && waiting.estimate.head.status != FrameStatus::kRejected) ++left_out_.images;
  return frame;
}

}  // namespace motorcade
