#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <unistd.h>

#include "apps/interface/call_guards.hpp"
#include "apps/interface/camera_model.hpp"
#include "apps/interface/final_taker.hpp"
#include "apps/interface/gray_image.hpp"
#include "apps/interface/pair_watch.hpp"
#include "apps/interface/result_conversion.hpp"
#include "apps/interface/result_queue.hpp"
#include "apps/interface/stamp_doubts.hpp"
#include "apps/interface/tracker_options.hpp"
#include "apps/interface/vehicle_motion_input.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "apps/watch/own_vehicle_news.hpp"
#include "apps/watch/vehicle_motion_news.hpp"
#include "io/errors.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {
namespace {

using PushStatus = Tracker::Push::Status;

/// Puts as many buffers into the pool as images are ever in use at once, in flight, in the entrance and in the stages'
/// memories, and some to spare: a pool may miss one that comes back in that moment. Their pages are untouched, and so
/// cost no memory until they are used.
void stock(ImagePool& pool, const Camera& camera) {
  constexpr std::size_t kImages = 32;
  std::vector<Image> images;
  while (images.size() < kImages) images.push_back(pool.acquire(camera.width_px, camera.height_px));
}

}  // namespace

/// Pairs go through checks, one copy and the rectification into the pipeline; a thread takes the pipeline's results and
/// converts them for those who take them, and calls the callback for finals; a second one calls that for results.
class Tracker::Impl {
 public:
  Impl(const Camera& camera, const Options& options, const PipelineConfig& config);
  ~Impl();

  Push push(const Pair& pair) noexcept;
  Push pushMotion(const VehicleMotion& motion) noexcept;
  void close();
  std::optional<Result> poll();
  std::optional<Result> wait(std::chrono::milliseconds timeout);
  bool done() const { return results_.done(); }
  /// Does this process have the tracker's memory, by `fork`, but none of its threads?
  bool inherited() const { return ::getpid() != process_; }
  void requireOwn() const;
  void handTo(std::function<void(Result)> take);
  void handFinalsTo(std::function<void(Result)> take);
  Counts counts() const;

 private:
  Push judge(const Pair& pair) noexcept;
  const char* problemWith(const Pair& pair) const;
  Push enter(const Pair& pair);
  const char* whyNot(Admission admission) const;
  void deliver();
  void deliverFinals(const std::vector<FrameEstimate>& finals);
  PipelineEnd finish();
  void handOn();
  template <class Call>
  void callGuarded(const char* what, const Call& call) const;

  pid_t process_ = ::getpid();
  Camera camera_;
  CameraModel model_;
  bool replay_;
  std::chrono::milliseconds patience_;
  LogCallback log_;
  ImagePool pool_;
  std::shared_ptr<VehicleMotionLog> vehicle_motion_ = std::make_shared<VehicleMotionLog>();
  SampleBits sample_bits_;
  std::atomic<int> visits_{0};
  std::atomic_flag pushing_;
  StampDoubts stamp_doubts_;  // the pushing thread's
  std::atomic<bool> closed_{false}, failed_{false}, abandoned_{false};
  std::atomic<std::int64_t> pushed_{0}, rejected_{0}, dropped_{0};
  ResultConversion convert_;        // the delivering thread's
  OwnVehicleNews own_vehicle_;      // the delivering thread's
  VehicleMotionNews vehicle_news_;  // the delivering thread's
  ResultQueue results_;
  FinalTaker finals_;
  ThreadPlacement placement_;
  PairWatch watch_;
  Pipeline pipeline_;
  std::jthread deliverer_;
  std::once_flag callback_wanted_;
  std::jthread caller_;  // of callbacks
};

Tracker::Impl::Impl(const Camera& camera, const Options& options, const PipelineConfig& config)
    : camera_(camera),
      model_(camera),
      replay_(options.policy == Policy::kReplay),
      patience_(options.patience),
      log_(logOf(options)),
      convert_(options.axes, options.masks),
      results_(options.policy),
      placement_(config.pipeline.placement),
      watch_(model_.rectified(), log_),
      pipeline_(config.pipeline, watch_.watched(makeStages(config, model_.rectified())), log_) {
  if (!replay_) stock(pool_, camera);
  deliverer_ = std::jthread([this] { deliver(); });  // at last: it would wait for results if anything failed after it
}

/// Throws where a lock may be held by a thread that is not there.
void Tracker::Impl::requireOwn() const {
  if (inherited())
    throw Error("tracker", "was made by process " + std::to_string(process_) +
                               ", of which this one is a child; make one after the fork");
}

/// Calls of other threads that wait come back first.
Tracker::Impl::~Impl() {
  constexpr std::chrono::microseconds kPause(100);
  closed_ = abandoned_ = true;
  pipeline_.abandon();
  results_.abandon();
  while (visits_ > 0) std::this_thread::sleep_for(kPause);
}

void Tracker::Impl::close() {
  const Visit visit(visits_);
  closed_ = true;
  pipeline_.close();
  results_.endWaitsForRoom();
}

Tracker::Push Tracker::Impl::push(const Pair& pair) noexcept {
  const Visit visit(visits_);
  pushed_.fetch_add(1, std::memory_order_relaxed);
  const Push outcome = judge(pair);
  if (outcome.status == PushStatus::kRejected) rejected_.fetch_add(1, std::memory_order_relaxed);
  if (outcome.status == PushStatus::kReplacedOlder) dropped_.fetch_add(1, std::memory_order_relaxed);
  return outcome;
}

Tracker::Push Tracker::Impl::pushMotion(const VehicleMotion& motion) noexcept {
  const Visit visit(visits_);
  if (closed_) return {PushStatus::kRejected, "the tracker was closed"};
  if (const char* const problem = problemOf(motion)) return {PushStatus::kRejected, problem};
  vehicle_motion_->add(sampleOf(motion));
  return {};
}

Tracker::Push Tracker::Impl::judge(const Pair& pair) noexcept {
  const OneAtATime one(pushing_);
  if (!one.entered()) return {PushStatus::kRejected, "another thread is pushing"};
  if (const char* const problem = problemWith(pair)) return {PushStatus::kRejected, problem};
  if (replay_ && !results_.waitForRoom(patience_))
    return {PushStatus::kRejected, "256 results wait, and nobody takes them"};
  Push outcome{.status = PushStatus::kRejected, .why = "out of memory"};
  try {
    outcome = enter(pair);
  } catch (const std::bad_alloc&) {  // the pair has not entered
  }
  if (replay_ && outcome.status == PushStatus::kRejected) results_.giveUpRoom();
  return outcome;
}

const char* Tracker::Impl::problemWith(const Pair& pair) const {
  if (pair.frame < -1 || pair.frame > kFarthestStamp_ns) return "its number is neither -1 nor one from 0 to 2^62";
  if (pair.stamp_ns < -kFarthestStamp_ns || pair.stamp_ns > kFarthestStamp_ns) return "its stamp is beyond 2^62 ns";
  const char* const left = problemOf(pair.left, camera_);
  return left != nullptr ? left : problemOf(pair.right, camera_);
}

Tracker::Push Tracker::Impl::enter(const Pair& pair) {
  StereoFrame frame;
  frame.head = {.frame = {pair.frame}, .stamp = {pair.stamp_ns}};
  frame.inputs = model_.inputs();
  frame.inputs.vehicle_samples = vehicle_motion_->count();
  if (frame.inputs.vehicle_samples > 0) frame.inputs.vehicle_motion = vehicle_motion_;
  frame.due = std::chrono::steady_clock::now();
  const int sample_bits = sample_bits_.of(pair);
  frame.left = model_.leftOf(grayImage(pair.left, sample_bits, pool_), pool_);
  frame.right = model_.rightOf(grayImage(pair.right, sample_bits, pool_), pool_);
  const Admission admission = pipeline_.push(std::move(frame));
  if (!isTaken(admission)) {
    if (const auto doubt = stamp_doubts_.refused(admission, pair.stamp_ns))
      tell(log_, motorcade::LogLevel::kError, [&] { return *doubt; });
    return {PushStatus::kRejected, whyNot(admission)};
  }
  stamp_doubts_.taken();
  return {admission == Admission::kReplacedOlder ? PushStatus::kReplacedOlder : PushStatus::kAccepted, ""};
}

/// Static text.
const char* Tracker::Impl::whyNot(Admission admission) const {
  if (admission != Admission::kClosed) return reasonOf(admission);
  return failed_ ? "the tracker has failed, as its log tells" : "the tracker was closed";
}

/// A pipeline that ends unasked tells why when it is finished.
void Tracker::Impl::deliver() {
  try {
    const PlacedThread placed(placement_);
    while (const auto result = pipeline_.next()) {
      if (const auto news = sample_bits_.news()) tell(log_, motorcade::LogLevel::kInfo, [&] { return *news; });
      if (const auto news = own_vehicle_.observe(*result->measurements))
        tell(log_, motorcade::LogLevel::kInfo, [&] { return *news; });
      if (const auto news = vehicle_news_.observe(*result->measurements))
        tell(log_, motorcade::LogLevel::kWarning, [&] { return *news; });
      Result converted = convert_(*result);
      if (converted.problem.empty()) converted.problem = watch_.problem();
      results_.put(std::move(converted));
      deliverFinals(result->finals);
      watch_.look(result->online.head.frame);
    }
    if (!closed_ || (finals_.isThere() && !abandoned_)) deliverFinals(finish().finals);
  } catch (const std::exception& error) {
    failed_ = true;
    pipeline_.abandon();
    results_.endWaitsForRoom();
    tell(log_, motorcade::LogLevel::kError, [&] { return std::string("no further results: ") + error.what(); });
  }
  results_.close();
}

void Tracker::Impl::deliverFinals(const std::vector<FrameEstimate>& finals) {
  for (const FrameEstimate& final : finals)
    if (finals_.isThere() && !abandoned_) callGuarded("finals", [&] { finals_.give(convert_.final(final)); });
}

/// Waits for a push that is under way, which a pipeline that ends must not meet; those that come later find it closed.
PipelineEnd Tracker::Impl::finish() {
  constexpr std::chrono::microseconds kPause(100);
  while (true) {
    const OneAtATime one(pushing_);
    if (one.entered()) return pipeline_.finish();
    std::this_thread::sleep_for(kPause);
  }
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
  const PlacedThread placed(placement_);
  for (bool more = true; more;) callGuarded("results", [&] { more = results_.handNext(); });
}

/// What a callback throws is logged, and the next call is made all the same.
template <class Call>
void Tracker::Impl::callGuarded(const char* what, const Call& call) const {
  const auto complain = [&](const char* why) {
    tell(log_, motorcade::LogLevel::kError, [&] { return std::string("the callback for ") + what + ": " + why; });
  };
  try {
    call();
  } catch (const std::exception& error) {
    complain(error.what());
  } catch (...) {
    complain("it threw what is no std::exception");
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

/// A child leaves the memory to the end of its process: what to join and to wait for is in the process that made it.
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
