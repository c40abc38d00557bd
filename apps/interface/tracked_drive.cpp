#include "apps/interface/tracked_drive.hpp"

#include <chrono>
#include <exception>
#include <string>
#include <utility>

#include "apps/interface/call_guards.hpp"

namespace motorcade {

using PushStatus = Tracker::Push::Status;

TrackedDrive::TrackedDrive(const Surroundings& around, const ResultConversion& convert)
    : around_(around),
      convert_(convert),
      watch_(around.model.rectified(), around.log),
      pipeline_(around.config.pipeline, watch_.watched(makeStages(around.config, around.model.rectified())),
                around.log) {}

TrackedDrive::~TrackedDrive() { abandon(); }

void TrackedDrive::start(std::int64_t first_id) {
  convert_.startIdsAt(first_id);
  deliverer_ = std::jthread([this] { deliver(); });
}

Tracker::Push TrackedDrive::push(StereoFrame frame) {
  const std::int64_t stamp_ns = frame.head.stamp.ns;
  frame.head.frame = numbers_.read(frame.head.frame);
  frame.inputs.vehicle_samples = vehicle_motion_->count();
  if (frame.inputs.vehicle_samples > 0) frame.inputs.vehicle_motion = vehicle_motion_;
  const Admission admission = pipeline_.push(std::move(frame));
  if (!isTaken(admission)) {
    if (const auto doubt = stamp_doubts_.refused(admission, stamp_ns))
      tell(around_.log, LogLevel::kError, [&] { return *doubt; });
    return {PushStatus::kRejected, whyNot(admission)};
  }
  stamp_doubts_.taken();
  return {admission == Admission::kReplacedOlder ? PushStatus::kReplacedOlder : PushStatus::kAccepted, ""};
}

/// Static text.
const char* TrackedDrive::whyNot(Admission admission) const {
  if (admission != Admission::kClosed) return reasonOf(admission);
  if (abandoned_) return "the tracker is being reset";
  return failed_ ? "the tracker has failed, as its log tells" : "the tracker was closed";
}

Tracker::Push TrackedDrive::pushMotion(const VehicleMotion& motion) noexcept {
  if (closed_) return {PushStatus::kRejected, "the tracker was closed"};
  if (const char* const problem = problemOf(motion)) return {PushStatus::kRejected, problem};
  vehicle_motion_->add(sampleOf(motion));
  return {};
}

void TrackedDrive::close() {
  closed_ = true;
  pipeline_.close();
}

void TrackedDrive::abandon() {
  closed_ = abandoned_ = true;
  pipeline_.abandon();
}

std::int64_t TrackedDrive::end() {
  deliverer_.join();
  return convert_.nextId();
}

/// Delivers the results. When the drive is abandoned, waits for its results go on for those of the next drive.
void TrackedDrive::deliver() {
  try {
    const PlacedThread placed(around_.config.pipeline.placement);
    deliverAll();
  } catch (const std::exception& error) {
    failed_ = true;
    pipeline_.abandon();
    around_.results.endWaitsForRoom();
    tell(around_.log, LogLevel::kError, [&] { return std::string("no further results: ") + error.what(); });
  }
  if (!abandoned_) around_.results.close();
}

/// A pipeline that ends unasked tells why when it is finished.
void TrackedDrive::deliverAll() {
  while (const auto result = pipeline_.next()) deliverOne(*result);
  if (!closed_ || around_.finals.isThere()) deliverFinals(lastFinals());
}

void TrackedDrive::deliverOne(const PipelineResult& result) {
  const auto told = [this](LogLevel level, const auto& news) {
    if (news) tell(around_.log, level, [&] { return *news; });
  };
  told(LogLevel::kInfo, sample_bits_.news());
  told(LogLevel::kWarning, numbers_.news());
  told(LogLevel::kInfo, own_vehicle_news_.observe(*result.measurements));
  told(LogLevel::kWarning, vehicle_motion_news_.observe(*result.measurements));
  Result converted = convert_(result);
  if (converted.problem.empty()) converted.problem = watch_.problem();
  around_.results.put(std::move(converted));
  deliverFinals(result.finals);
  watch_.look(result.online.head.frame);
}

void TrackedDrive::deliverFinals(const std::vector<FrameEstimate>& finals) {
  for (const FrameEstimate& final : finals)
    if (around_.finals.isThere() && !abandoned_)
      callLogged(around_.log, "finals", [&] { around_.finals.give(convert_.final(final)); });
}

/// Waits for a push that is under way, as a pipeline must not end during it. Later pushes find it closed.
std::vector<FrameEstimate> TrackedDrive::lastFinals() {
  constexpr std::chrono::microseconds kPause(100);
  while (!abandoned_) {
    const OneAtATime one(around_.pushing);
    if (one.entered()) return pipeline_.finish().finals;
    std::this_thread::sleep_for(kPause);
  }
  return {};
}

}  // namespace motorcade
