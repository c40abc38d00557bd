#include <algorithm>
#include <atomic>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "apps/interface/camera_model.hpp"
#include "apps/interface/gray_image.hpp"
#include "apps/interface/result_conversion.hpp"
#include "apps/interface/result_queue.hpp"
#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "io/errors.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {
namespace {

using PushStatus = Tracker::Push::Status;

/// Tries the placement on a thread of its own, so that a refusal is the constructor's to tell.
void requirePlacement(const ThreadPlacement& placement) {
  for (const int cpu : placement.cpus)
    if (cpu < 0) throw Error("options.cpus", "has " + std::to_string(cpu) + "; processors count from 0");
  if (placement.realtime_priority < 0 || placement.realtime_priority > 99)
    throw Error("options.realtime_priority", "is " + std::to_string(placement.realtime_priority) + "; it is 0 to 99");
  const auto problemWith = [](const ThreadPlacement& part) {
    std::string problem;
    std::jthread([&] { problem = PlacedThread(part).problem(); }).join();
    return problem;
  };
  if (const auto problem = problemWith({.cpus = placement.cpus}); !problem.empty())
    throw Error("options.cpus", problem);
  if (const auto problem = problemWith({.realtime_priority = placement.realtime_priority}); !problem.empty())
    throw Error("options.realtime_priority", problem);
}

PipelineConfig configOf(const Tracker::Options& options) {
  PipelineConfig config;
  try {
    applyToml(config, options.settings, "options.settings");
  } catch (const UsageError& error) {
    throw Error("options.settings", error.what());
  }
  if (options.threads < 1 || options.threads > 64)
    throw Error("options.threads", "is " + std::to_string(options.threads) + "; it is 1 to 64");
  if (options.patience.count() < 0) throw Error("options.patience", "is negative");
  config.pipeline.threads = options.threads;
  config.pipeline.policy = options.policy == Tracker::Policy::kLive ? InputPolicy::kLive : InputPolicy::kReplay;
  config.pipeline.placement = {.cpus = options.cpus, .realtime_priority = options.realtime_priority};
  requirePlacement(config.pipeline.placement);
  return config;
}

LogCallback logOf(const Tracker::Options& options) {
  if (!options.log) return [](motorcade::LogLevel, const std::string&) {};
  return [log = options.log](motorcade::LogLevel level, const std::string& text) {
    switch (level) {
      case LogLevel::kInfo:
        return log(Tracker::LogLevel::kInfo, text);
      case LogLevel::kWarning:
        return log(Tracker::LogLevel::kWarning, text);
      case LogLevel::kError:
        return log(Tracker::LogLevel::kError, text);
    }
  };
}

const char* reasonOf(Admission admission) {
  switch (admission) {
    case Admission::kLate:
      return "its number is not after that of the pair before";
    case Admission::kOutOfOrder:
      return "its stamp does not follow that of the pair before";
    case Admission::kClosed:
      return "the tracker was closed";
    case Admission::kTaken:
    case Admission::kReplacedOlder:
      break;
  }
  return "";
}

/// Holds off a second thread that pushes at the same time.
class OneAtATime {
 public:
  explicit OneAtATime(std::atomic_flag& busy) : busy_(busy), entered_(!busy.test_and_set(std::memory_order_acquire)) {}
  ~OneAtATime() {
    if (entered_) busy_.clear(std::memory_order_release);
  }
  OneAtATime(const OneAtATime&) = delete;
  OneAtATime& operator=(const OneAtATime&) = delete;
  bool entered() const { return entered_; }

 private:
  std::atomic_flag& busy_;
  bool entered_;
};

}  // namespace

/// Pairs go through checks, one copy and the rectification into the pipeline; a thread takes the pipeline's results,
/// converts them and hands them on.
class Tracker::Impl {
 public:
  Impl(const Camera& camera, const Options& options, const PipelineConfig& config);
  ~Impl();

  Push push(const Pair& pair);
  void close() { pipeline_.close(); }
  ResultQueue& results() { return results_; }
  Counts counts() const;

 private:
  const char* problemWith(const Pair& pair) const;
  Push enter(const Pair& pair);
  void deliver();
  void hand(Result result);

  Camera camera_;
  CameraModel model_;
  bool replay_;
  std::chrono::milliseconds patience_;
  LogCallback log_;
  ImagePool pool_;
  std::atomic_flag pushing_;
  std::atomic<std::int64_t> pushed_{0}, rejected_{0}, dropped_{0};
  ResultConversion convert_;  // the delivering thread's
  ResultQueue results_;
  ThreadPlacement placement_;
  Pipeline pipeline_;
  std::jthread deliverer_;
};

Tracker::Impl::Impl(const Camera& camera, const Options& options, const PipelineConfig& config)
    : camera_(camera),
      model_(camera),
      replay_(options.policy == Policy::kReplay),
      patience_(options.patience),
      log_(logOf(options)),
      convert_(options.axes, options.masks),
      placement_(config.pipeline.placement),
      pipeline_(config.pipeline, makeStages(config, model_.rectified()), log_),
      deliverer_([this] { deliver(); }) {}

Tracker::Impl::~Impl() { pipeline_.abandon(); }

Tracker::Push Tracker::Impl::push(const Pair& pair) {
  pushed_.fetch_add(1, std::memory_order_relaxed);
  const OneAtATime one(pushing_);
  Push outcome{.status = PushStatus::kRejected, .why = "another thread is pushing"};
  if (one.entered()) {
    outcome.why = problemWith(pair);
    if (outcome.why == nullptr) outcome = enter(pair);
  }
  if (outcome.status == PushStatus::kRejected) rejected_.fetch_add(1, std::memory_order_relaxed);
  if (outcome.status == PushStatus::kReplacedOlder) dropped_.fetch_add(1, std::memory_order_relaxed);
  return outcome;
}

const char* Tracker::Impl::problemWith(const Pair& pair) const {
  const char* const left = problemOf(pair.left, camera_);
  return left != nullptr ? left : problemOf(pair.right, camera_);
}

Tracker::Push Tracker::Impl::enter(const Pair& pair) {
  if (replay_ && !results_.waitForRoom(patience_))
    return {PushStatus::kRejected, "256 results wait, and nobody takes them"};
  StereoFrame frame;
  frame.frame = {pair.frame};
  frame.stamp = {pair.stamp_ns};
  frame.due = std::chrono::steady_clock::now();
  frame.left = model_.leftOf(grayImage(pair.left, pool_), pool_);
  frame.right = model_.rightOf(grayImage(pair.right, pool_), pool_);
  const Admission admission = pipeline_.push(std::move(frame));
  if (isTaken(admission))
    return {admission == Admission::kReplacedOlder ? PushStatus::kReplacedOlder : PushStatus::kAccepted, ""};
  if (replay_) results_.giveUpRoom();
  return {PushStatus::kRejected, reasonOf(admission)};
}

void Tracker::Impl::deliver() {
  const PlacedThread placed(placement_);
  try {
    while (const auto result = pipeline_.next()) hand(convert_(*result));
  } catch (const std::exception& error) {
    pipeline_.abandon();
    tell(log_, motorcade::LogLevel::kError, [&] { return std::string("no further results: ") + error.what(); });
  }
  results_.close();
}

void Tracker::Impl::hand(Result result) {
  const auto take = results_.put(result);
  if (!take) return;
  try {
    take(std::move(result));
  } catch (const std::exception& error) {
    tell(log_, motorcade::LogLevel::kError, [&] { return std::string("the callback for results: ") + error.what(); });
  }
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
    : impl_(std::make_unique<Impl>(camera, options, configOf(options))) {
} catch (const Error&) {
  throw;
} catch (const std::exception& error) {
  throw Error("options", error.what());
}
Tracker::~Tracker() = default;

Tracker::Push Tracker::push(const Pair& pair) noexcept {
  try {
    return impl_->push(pair);
  } catch (...) {
    return {Push::Status::kRejected, "out of memory"};
  }
}
void Tracker::close() noexcept { impl_->close(); }
std::optional<Result> Tracker::poll() { return impl_->results().poll(); }
std::optional<Result> Tracker::wait(std::chrono::milliseconds timeout) { return impl_->results().wait(timeout); }
bool Tracker::done() const noexcept { return impl_->results().done(); }
void Tracker::on_result(std::function<void(Result)> take) { impl_->results().handTo(std::move(take)); }
Tracker::Counts Tracker::counts() const noexcept { return impl_->counts(); }

}  // namespace motorcade
