#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <shared_mutex>
#include <string>
#include <thread>
#include <utility>

#include <unistd.h>

#include "apps/interface/call_guards.hpp"
#include "apps/interface/camera_model.hpp"
#include "apps/interface/pair_input.hpp"
#include "apps/interface/result_conversion.hpp"
#include "apps/interface/result_queue.hpp"
#include "apps/interface/tracked_drive.hpp"
#include "apps/interface/tracker_options.hpp"
#include "io/files/errors.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {
namespace {

using PushStatus = Tracker::Push::Status;

}  // namespace

/// Checks pairs, copies them once, rectifies them and hands them to the drive's pipeline, which delivers its results.
/// A thread calls the callback for results, if there is one.
class Tracker::Impl {
 public:
  Impl(const Camera& camera, const Options& options, const PipelineConfig& config);
  ~Impl();

  Push push(const Pair& pair) noexcept;
  Push pushMotion(const VehicleMotion& motion) noexcept;
  void close();
  void reset();
  std::optional<Result> poll();
  std::optional<Result> wait(std::chrono::milliseconds timeout);
  bool done() const { return results_.done(); }
  /// True in a child of `fork`, which has the tracker's memory, but none of its threads.
  bool inherited() const { return ::getpid() != process_; }
  void requireOwn() const;
  void handTo(std::function<void(Result)> take);
  void handFinalsTo(std::function<void(Result)> take);
  Counts counts() const;

 private:
  Push judge(const Pair& pair) noexcept;
  Push enter(const Pair& pair);
  void handOn();
  std::unique_ptr<TrackedDrive> newDrive();
  void requireOtherThread() const;
  void replaceDrive(std::unique_ptr<TrackedDrive> next);

  pid_t process_ = ::getpid();
  CameraModel model_;
  PipelineConfig config_;
  Axes axes_;
  bool replay_, masks_;
  std::chrono::milliseconds patience_;
  LogCallback log_;
  PairInput input_;  // the pushing thread's
  std::atomic<int> visits_{0};
  std::atomic_flag pushing_;
  std::atomic<std::int64_t> pushed_{0}, rejected_{0}, dropped_{0};
  std::int64_t entered_ = 0;  // that were accepted; the pushing thread's
  ResultQueue results_;
  FinalTaker finals_;
  mutable std::shared_mutex drive_mutex_;  // of the pointer, for all but the pushing thread
  std::unique_ptr<TrackedDrive> drive_;
  std::mutex reset_mutex_;
  std::once_flag callback_wanted_;
  std::jthread caller_;  // of callbacks
};

/// The drive's thread starts last: it would wait for results if anything failed after it.
Tracker::Impl::Impl(const Camera& camera, const Options& options, const PipelineConfig& config)
    : model_(camera),
      config_(config),
      axes_(options.axes),
      replay_(options.policy == Policy::kReplay),
      masks_(options.masks),
      patience_(options.patience),
      log_(logOf(options)),
      input_(camera, model_, options.policy),
      results_(options.policy),
      drive_(newDrive()) {
  drive_->start(0);
}

std::unique_ptr<TrackedDrive> Tracker::Impl::newDrive() {
  const TrackedDrive::Surroundings around{config_, model_, log_, pushing_, results_, finals_};
  return std::make_unique<TrackedDrive>(around, ResultConversion(axes_, masks_));
}

/// Throws in a process where a lock may be held by a thread that does not exist there.
void Tracker::Impl::requireOwn() const {
  if (inherited())
    throw Error("tracker", "was made by process " + std::to_string(process_) +
                               ", of which this one is a child; make one after the fork");
}

/// Waits until waiting calls of other threads have returned.
Tracker::Impl::~Impl() {
  constexpr std::chrono::microseconds kPause(100);
  drive_->abandon();
  results_.abandon();
  while (visits_ > 0) std::this_thread::sleep_for(kPause);
}

void Tracker::Impl::close() {
  const Visit visit(visits_);
  const std::shared_lock lock(drive_mutex_);
  drive_->close();
  results_.endWaitsForRoom();
}

/// The new drive is made before the old one goes: if memory runs out, nothing has changed.
void Tracker::Impl::reset() {
  constexpr std::chrono::microseconds kPause(100);
  const Visit visit(visits_);
  requireOtherThread();
  const std::scoped_lock resetting(reset_mutex_);
  auto next = newDrive();
  results_.discard();
  drive_->abandon();
  while (true) {
    const OneAtATime one(pushing_);
    if (one.entered()) return replaceDrive(std::move(next));
    std::this_thread::sleep_for(kPause);
  }
}

void Tracker::Impl::requireOtherThread() const {
  const std::shared_lock lock(drive_mutex_);
  if (drive_->delivers()) throw Error("reset", "cannot be called by the callback for finals, which it would wait for");
}

/// Replaces the drive. Pairs without a result count as dropped.
void Tracker::Impl::replaceDrive(std::unique_ptr<TrackedDrive> next) {
  const std::int64_t first_id = drive_->end();
  dropped_ = entered_ - results_.given();
  results_.restart();
  {
    const std::scoped_lock lock(drive_mutex_);
    drive_.swap(next);
  }
  drive_->start(first_id);
}

Tracker::Push Tracker::Impl::push(const Pair& pair) noexcept {
  const Visit visit(visits_);
  pushed_.fetch_add(1, std::memory_order_relaxed);
  const Push outcome = judge(pair);
  if (outcome.status == PushStatus::kRejected) rejected_.fetch_add(1, std::memory_order_relaxed);
  return outcome;
}

Tracker::Push Tracker::Impl::pushMotion(const VehicleMotion& motion) noexcept {
  const Visit visit(visits_);
  const std::shared_lock lock(drive_mutex_);
  return drive_->pushMotion(motion);
}

Tracker::Push Tracker::Impl::judge(const Pair& pair) noexcept {
  const OneAtATime one(pushing_);
  if (!one.entered()) return {PushStatus::kRejected, "another thread is pushing"};
  if (const char* const problem = input_.problemWith(pair)) return {PushStatus::kRejected, problem};
  if (replay_ && !results_.waitForRoom(patience_))
    return {PushStatus::kRejected, "256 results wait, and nobody takes them"};
  Push outcome{.status = PushStatus::kRejected, .why = "out of memory"};
  try {
    outcome = enter(pair);
  } catch (const std::bad_alloc&) {  // the pair has not entered
  }
  if (outcome.status == PushStatus::kReplacedOlder) dropped_.fetch_add(1, std::memory_order_relaxed);
  if (outcome.status != PushStatus::kRejected)
    ++entered_;
  else if (replay_)
    results_.giveUpRoom();
  return outcome;
}

Tracker::Push Tracker::Impl::enter(const Pair& pair) {
  return drive_->push(input_.frameOf(pair, drive_->sampleBitsOf(pair)));
}

std::optional<Result> Tracker::Impl::poll() {
  const Visit visit(visits_);
  return results_.poll();
}

std::optional<Result> Tracker::Impl::wait(std::chrono::milliseconds timeout) {
  const Visit visit(visits_);
  return results_.wait(timeout);
}

void Tracker::Impl::handTo(std::function<void(Result)> take) {
  const Visit visit(visits_);
  std::call_once(callback_wanted_, [this] { caller_ = std::jthread([this] { handOn(); }); });
  results_.handTo(std::move(take));
}

void Tracker::Impl::handFinalsTo(std::function<void(Result)> take) {
  const Visit visit(visits_);
  finals_.handTo(std::move(take));
}

void Tracker::Impl::handOn() {
  const PlacedThread placed(config_.pipeline.placement);
  for (bool more = true; more;) callLogged(log_, "results", [&] { more = results_.handNext(); });
}

Tracker::Counts Tracker::Impl::counts() const {
  return {.pushed = pushed_.load(),
          .rejected = rejected_.load(),
          .dropped = dropped_.load(),
          .results = results_.given(),
          .untaken = results_.untaken()};
}

Tracker::Tracker(const Camera& camera) : Tracker(camera, Options{}) {}
Tracker::Tracker(const Camera& camera, const Options& options) try
    : impl_(std::make_unique<Impl>(camera, options, configOf(options, camera))) {
} catch (const Error&) {
  throw;
} catch (const UsageError& error) {  // a setting that needs what is not installed
  throw Error("options.settings", error.what());
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  throw Error("options", error.what());
}

/// A forked child leaves the memory to the end of its process: the threads to join are in the parent.
Tracker::~Tracker() {
  if (impl_->inherited()) static_cast<void>(impl_.release());
}

Tracker::Push Tracker::push(const Pair& pair) noexcept {
  if (impl_->inherited()) return {PushStatus::kRejected, "the tracker was made by the process before a fork"};
  return impl_->push(pair);
}
Tracker::Push Tracker::push_motion(const VehicleMotion& motion) noexcept {
  if (impl_->inherited()) return {PushStatus::kRejected, "the tracker was made by the process before a fork"};
  return impl_->pushMotion(motion);
}
void Tracker::close() noexcept {
  if (!impl_->inherited()) impl_->close();
}
void Tracker::reset() {
  impl_->requireOwn();
  impl_->reset();
}
std::optional<Result> Tracker::poll() {
  impl_->requireOwn();
  return impl_->poll();
}
std::optional<Result> Tracker::wait(std::chrono::milliseconds timeout) {
  impl_->requireOwn();
  return impl_->wait(timeout);
}
bool Tracker::done() const noexcept { return impl_->inherited() || impl_->done(); }
void Tracker::on_result(std::function<void(Result)> take) {
  impl_->requireOwn();
  impl_->handTo(std::move(take));
}
void Tracker::on_final(std::function<void(Result)> take) {
  impl_->requireOwn();
  impl_->handFinalsTo(std::move(take));
}
Tracker::Counts Tracker::counts() const noexcept { return impl_->inherited() ? Counts{} : impl_->counts(); }

}  // namespace motorcade
