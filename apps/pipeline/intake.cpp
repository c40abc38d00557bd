#include "apps/pipeline/intake.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>

namespace motorcade {
namespace {

/// Most frames lost between two others that are named one by one; if there are more, they are counted.
constexpr std::size_t kMostMissed = 4096;

/// Least time between pairs. No camera takes them faster, and the stamps of a burst that was stamped on arrival give no
/// speeds.
constexpr std::int64_t kTooClose_ns = 500'000;

std::string whyOutOfOrder(std::int64_t step_ns) {
  const std::string step = std::to_string(1e-9 * static_cast<double>(step_ns)) + " s after that of the frame before it";
  if (step_ns > FrameClock::kFarAhead_ns) return "its time is " + step + "; look at the unit of the times";
  if (step_ns > 0 && step_ns < kTooClose_ns)
    return "its time is only " + step + ", as no camera's is; look at the unit of the times";
  return "its time does not follow that of the frame before it";
}

/// Shares a frame. If memory for it is lacking, the frame gives up its images.
StereoFramePtr shared(StereoFrame frame) {
  const auto make = [&] { return std::make_shared<const StereoFrame>(std::move(frame)); };
  try {
    return make();
  } catch (const std::bad_alloc&) {
    frame.reject(FrameCause::kUnusable, kNoMemoryLeft);
    return make();
  }
}

}  // namespace

Intake::Intake(const PipelineParams& params, FreeJobs& free_jobs, Entrance& entrance, LogCallback log)
    : policy_(params.policy),
      free_jobs_(free_jobs),
      entrance_(entrance),
      log_(std::move(log)),
      input_(ringCapacity(params)),
      missed_(kMostMissed) {}

Admission Intake::push(StereoFrame frame) {
  entering_.store(true);
  const Admission admission = closed_.load() ? Admission::kClosed : judge(std::move(frame));
  entering_.store(false);
  entering_.notify_one();
  return admission;
}

Admission Intake::judge(StereoFrame frame) {
  if (!frame.head.frame.valid()) frame.head.frame = next_id_;
  if (frame.head.frame < next_id_) {
    late_.fetch_add(1, std::memory_order_relaxed);
    // A camera that starts anew sets back its clock, too: the same few frames show both.
    if (stamped_ && frame.head.stamp <= *stamped_) static_cast<void>(clock_.read(frame.head.stamp));
    return Admission::kLate;
  }
  next_id_ = {frame.head.frame.value + 1};
  const std::int64_t step_ns =
      frame.head.stamp.ns - std::exchange(stamped_, frame.head.stamp).value_or(frame.head.stamp).ns;
  if (step_ns > 0 && step_ns < kTooClose_ns) return refuse(frame, step_ns, Admission::kTooClose);
  const auto time = clock_.read(frame.head.stamp);
  if (!time) return refuse(frame, step_ns, clock_.refusedFarAhead() ? Admission::kFarAhead : Admission::kOutOfOrder);
  frame.head.stamp = *time;
  frame.inputs.clock_ahead_ns = clock_.ahead_ns();
  const Admission admission = enter(std::move(frame));
  if (isTaken(admission)) received_.fetch_add(1, std::memory_order_relaxed);
  return admission;
}

/// Refuses a frame. Its time is the expected one; a frame that is too close keeps its own.
Admission Intake::refuse(const StereoFrame& frame, std::int64_t step_ns, Admission why) {
  const Timestamp time =
      why == Admission::kTooClose ? Timestamp{frame.head.stamp.ns + clock_.ahead_ns()} : clock_.expected();
  announce({.head = {.frame = frame.head.frame,
                     .stamp = time,
                     .status = FrameStatus::kRejected,
                     .cause = FrameCause::kOutOfOrder},
            .step_ns = step_ns});
  refused_.fetch_add(1, std::memory_order_relaxed);
  received_.fetch_add(1, std::memory_order_relaxed);
  return why;
}

Admission Intake::enter(StereoFrame frame) {
  const std::int64_t turn = ++turns_;
  if (!live()) return input_.push({std::move(frame), turn}) ? Admission::kTaken : Admission::kClosed;
  announce(droppedFrame(frame.head.frame, frame.head.stamp));
  return newest_.put({std::move(frame), turn}) ? Admission::kReplacedOlder : Admission::kTaken;
}

void Intake::passOver(FrameId frame, Timestamp stamp) {
  assert(frame >= next_id_);
  if (closed_.load()) return;
  next_id_ = {frame.value + 1};
  ++turns_;
  announce(droppedFrame(frame, {stamp.ns + clock_.ahead_ns()}));
  passed_over_.fetch_add(1, std::memory_order_relaxed);
  received_.fetch_add(1, std::memory_order_relaxed);
}

void Intake::announce(MissedFrame frame) { missed_.tryPush(frame); }

void Intake::close() {
  closed_.store(true);
  input_.close();
  newest_.close();
}

Job* Intake::next(const std::function<bool()>& given_up) {
  Job* const job = free_jobs_.take(given_up);
  if (!job) return nullptr;
  if (live()) entrance_.waitForTurn(given_up);
  auto frame = take();
  if (!frame) return nullptr;
  admit(*job, std::move(*frame));
  return job;
}

/// No frame is lost when another thread's `close` overtakes it on its way in.
std::optional<Intake::Entering> Intake::take() {
  auto frame = live() ? newest_.take() : input_.pop();
  if (frame) return frame;
  entering_.wait(true);
  return live() ? newest_.tryTake() : input_.tryPop();
}

void Intake::admit(Job& job, Entering entering) {
  StereoFrame& frame = entering.frame;
  job.timing = FrameTiming{};
  job.timing.admitted = std::chrono::steady_clock::now();
  if (frame.due == SteadyTime{}) frame.due = job.timing.admitted;
  job.timing.head = frame.head;
  job.timing.due = frame.due;
  job.timing.decode_ms = frame.decode_ms;
  job.timing.decoded = frame.decoded;
  job.dropped = missedBefore(frame.head.frame);
  job.dropped_unnamed = droppedUnnamed(job.dropped, entering.turn);
  tellOfLost(job);
  tellOfClock(frame);
  job.frame = shared(std::move(frame));
  job.sequence = admitted_++;
  if (job.frame->rejected())
    tell(log_, LogLevel::kWarning, [&] { return job.name() + " is rejected: " + job.frame->problem; });
}

/// Number of dropped frames between the last admitted one and that of `turn` that are not among the named ones.
std::int64_t Intake::droppedUnnamed(const std::vector<MissedFrame>& named, std::int64_t turn) {
  const std::int64_t between = turn - std::exchange(last_turn_, turn) - 1;
  return between -
         std::ranges::count(named, FrameStatus::kDropped, [](const MissedFrame& frame) { return frame.head.status; });
}

void Intake::tellOfLost(const Job& job) {
  for (const MissedFrame& missed : job.dropped)
    if (missed.head.status == FrameStatus::kRejected)
      tell(log_, LogLevel::kWarning, [&] {
        return "frame " + std::to_string(missed.head.frame.value) + " is rejected: " + whyOutOfOrder(missed.step_ns);
      });
  if (job.dropped_unnamed > 0)
    tell(log_, LogLevel::kWarning, [&] {
      return std::to_string(job.dropped_unnamed) + " frames that were dropped before " + job.name() +
             " are counted, but have no line in the results: there were too many at once";
    });
}

/// Logs a change of the clock with the first frame that has a corrected time.
void Intake::tellOfClock(const StereoFrame& frame) {
  const std::int64_t ahead_ns = frame.inputs.clock_ahead_ns;
  if (ahead_ns == std::exchange(told_ahead_ns_, ahead_ns)) return;
  tell(log_, LogLevel::kWarning, [&] {
    return "frame " + std::to_string(frame.head.frame.value) +
           ": the clock of the camera was set back; from here on times are " +
           std::to_string(1e-9 * static_cast<double>(ahead_ns)) + " s later than its own";
  });
}

std::vector<MissedFrame> Intake::missedBefore(FrameId frame) {
  std::vector<MissedFrame> before;
  for (;;) {
    if (!missed_ahead_) missed_ahead_ = missed_.tryPop();
    if (!missed_ahead_ || missed_ahead_->head.frame > frame) return before;
    if (missed_ahead_->head.frame < frame) before.push_back(*missed_ahead_);
    missed_ahead_.reset();
  }
}

std::vector<MissedFrame> Intake::missedAtLast() {
  constexpr FrameId kNever{std::numeric_limits<std::int64_t>::max()};
  return missedBefore(kNever);
}

}  // namespace motorcade
