#include "python/src/tracker_binding.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <pybind11/stl.h>
#include <unistd.h>

#include "python/src/callback.hpp"
#include "python/src/camera_input.hpp"
#include "python/src/image_input.hpp"
#include "python/src/python_value.hpp"
#include "python/src/result_output.hpp"
#include "python/src/tracker_input.hpp"

namespace py = pybind11;

namespace motorcade::python {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<int> trackers_leaving{0};  // that a thread of its own brings to their end

std::function<void(Tracker::LogLevel, const std::string&)> logOf(const py::object& log) {
  if (log.is_none()) return {};
  return [callback = Callback(log)](Tracker::LogLevel level, const std::string& text) {
    callback([&] {
      const auto line = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace");
      return py::make_tuple(toPython(level), py::reinterpret_steal<py::object>(line));
    });
  };
}

std::function<void(Result)> takerOf(const py::object& take) {
  if (take.is_none()) return {};
  return
      [callback = Callback(take)](const Result& result) { callback([&] { return py::make_tuple(toPython(result)); }); };
}

Clock::time_point deadlineOf(std::optional<double> timeout_s) {
  constexpr double kLongest_s = 1e8;  // some years
  if (timeout_s && std::isnan(*timeout_s)) throw py::value_error("timeout_s: is no number; None waits for ever");
  const double wait_s = std::clamp(timeout_s.value_or(kLongest_s), 0.0, kLongest_s);
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait_s));
}

}  // namespace

struct TrackerBinding::Running {
  Running(const Camera& camera, const Tracker::Options& options) : tracker(camera, options) {}

  const pid_t process = ::getpid();
  std::atomic<int> visits{0};
  std::atomic<bool> stopping{false}, hands_on{false};
  Tracker tracker;
};

/// A call that may run without the GIL. The tracker outlives it.
class TrackerBinding::Visit {
 public:
  explicit Visit(Running& running) : running_(running) {
    if (running.process != ::getpid())
      throw std::runtime_error(
          "this tracker's threads are in the process that was forked; make a Tracker in each process, after the fork");
    ++running_.visits;
  }
  ~Visit() { --running_.visits; }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

 private:
  Running& running_;
};

TrackerBinding::TrackerBinding(const py::object& camera, const py::object& log, const py::kwargs& options) {
  const Camera described = cameraOf(camera);
  Tracker::Options chosen = optionsOf(options);
  chosen.log = logOf(log);
  const py::gil_scoped_release release;
  running_ = std::make_unique<Running>(described, chosen);
}

// If a lock cannot be taken, this throws, and the program ends.
TrackerBinding::~TrackerBinding() { stop(); }  // NOLINT(bugprone-exception-escape)

Tracker::Push TrackerBinding::push(const Pair& pair) {
  if (!running_) return {.status = Tracker::Push::Status::kRejected, .why = "the tracker was stopped"};
  Running& running = *running_;
  const Visit visit(running);
  const py::gil_scoped_release release;
  return running.tracker.push(pair);
}

Tracker::Push TrackerBinding::pushMotion(const VehicleMotion& motion) {
  if (!running_) return {.status = Tracker::Push::Status::kRejected, .why = "the tracker was stopped"};
  Running& running = *running_;
  const Visit visit(running);
  return running.tracker.push_motion(motion);
}

std::optional<Result> TrackerBinding::poll() {
  if (!running_) return std::nullopt;
  Running& running = *running_;
  const Visit visit(running);
  const py::gil_scoped_release release;
  return running.tracker.poll();
}

std::optional<Result> TrackerBinding::wait(std::optional<double> timeout_s) {
  constexpr std::chrono::milliseconds kSlice(50);  // after which signals, and whether it was stopped, are looked at
  const auto deadline = deadlineOf(timeout_s);
  if (!running_) return std::nullopt;
  Running& running = *running_;
  const Visit visit(running);
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    std::optional<Result> result;
    {
      const py::gil_scoped_release release;
      result = running.tracker.wait(std::min(left, kSlice));
    }
    if (result || left <= kSlice || running.tracker.done() || running.hands_on || running.stopping) return result;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

bool TrackerBinding::done() const {
  if (!running_) return true;
  const Visit visit(*running_);
  return running_->tracker.done();
}

bool TrackerBinding::handsOn() const { return running_ && running_->hands_on; }

void TrackerBinding::handTo(const py::object& take) {
  auto taker = takerOf(take);
  if (!running_) return;
  Running& running = *running_;
  const Visit visit(running);
  running.hands_on = taker != nullptr;
  const py::gil_scoped_release release;
  running.tracker.on_result(std::move(taker));
}

void TrackerBinding::handFinalsTo(const py::object& take) {
  auto taker = takerOf(take);
  if (!running_) return;
  Running& running = *running_;
  const Visit visit(running);
  const py::gil_scoped_release release;
  running.tracker.on_final(std::move(taker));
}

Tracker::Counts TrackerBinding::counts() const {
  if (!running_) return last_counts_;
  const Visit visit(*running_);
  return running_->tracker.counts();
}

void TrackerBinding::close() {
  if (!running_) return;
  Running& running = *running_;
  const Visit visit(running);
  const py::gil_scoped_release release;
  running.tracker.close();
}

void TrackerBinding::reset() {
  if (!running_) return;
  Running& running = *running_;
  const Visit visit(running);
  const py::gil_scoped_release release;
  running.tracker.reset();
}

void TrackerBinding::stop() {
  if (!running_) return;
  if (running_->process != ::getpid()) {
    static_cast<void>(running_.release());  // its threads, which would be joined, are another process's
    return;
  }
  last_counts_ = running_->tracker.counts();
  auto running = std::move(running_);
  if (Callback::isUnderWay()) return endBehindTheScenes(std::move(running));
  const py::gil_scoped_release release;
  end(std::move(running));
}

void TrackerBinding::end(std::unique_ptr<Running> running) {
  constexpr std::chrono::microseconds kPause(200);
  running->stopping = true;
  running->tracker.close();  // ends a push that waits
  while (running->visits > 0) std::this_thread::sleep_for(kPause);
}

/// Ends the tracker on a thread of its own. If none can be started, the tracker stays until the process ends.
void TrackerBinding::endBehindTheScenes(std::unique_ptr<Running> running) {
  Running* const leaving = running.release();
  ++trackers_leaving;
  try {
    std::thread([leaving] {
      end(std::unique_ptr<Running>(leaving));
      --trackers_leaving;
    }).detach();
  } catch (const std::system_error&) {
    --trackers_leaving;
  }
}

void TrackerBinding::waitForLeaving() {
  constexpr std::chrono::microseconds kPause(200);
  const py::gil_scoped_release release;
  while (trackers_leaving > 0) std::this_thread::sleep_for(kPause);
}

namespace {

/// Pushes the left and right image and the instance labels. Python's buffers are held until the library has copied
/// them.
py::object push(TrackerBinding& tracker, const py::tuple& images, const py::object& stamp_ns, const py::object& frame,
                const std::string& format) {
  const auto color_format = colorFormatOf(format);
  const ImageInput left(images[0], "left", color_format), right(images[1], "right", color_format),
      instances(images[2], "instances", std::nullopt);
  return toPython(tracker.push({.left = left.view(),
                                .right = right.view(),
                                .stamp_ns = valueOf<std::int64_t>(stamp_ns, "stamp_ns"),
                                .frame = valueOf<std::int64_t>(frame, "frame"),
                                .instances = instances.view()}));
}

py::object pushMotion(TrackerBinding& tracker, const py::object& stamp_ns, const py::object& speed_mps,
                      const py::object& yaw_rate_radps, const py::object& speed_sigma_mps,
                      const py::object& yaw_rate_sigma_radps) {
  return toPython(
      tracker.pushMotion({.stamp_ns = valueOf<std::int64_t>(stamp_ns, "stamp_ns"),
                          .speed_mps = valueOf<double>(speed_mps, "speed_mps"),
                          .yaw_rate_radps = valueOf<double>(yaw_rate_radps, "yaw_rate_radps"),
                          .speed_sigma_mps = valueOf<double>(speed_sigma_mps, "speed_sigma_mps"),
                          .yaw_rate_sigma_radps = valueOf<double>(yaw_rate_sigma_radps, "yaw_rate_sigma_radps")}));
}

py::object optional(const std::optional<Result>& result) { return result ? toPython(*result) : py::none(); }

}  // namespace

void bindTracker(py::module_& module) {
  py::class_<TrackerBinding>(module, "Tracker")
      .def(py::init<const py::object&, const py::object&, const py::kwargs&>())
      .def("push", &push)
      .def("push_motion", &pushMotion)
      .def("poll", [](TrackerBinding& tracker) { return optional(tracker.poll()); })
      .def("wait",
           [](TrackerBinding& tracker, std::optional<double> timeout_s) { return optional(tracker.wait(timeout_s)); })
      .def("on_result", &TrackerBinding::handTo)
      .def("on_final", &TrackerBinding::handFinalsTo)
      .def("hands_on", &TrackerBinding::handsOn)
      .def("close", &TrackerBinding::close)
      .def("reset", &TrackerBinding::reset)
      .def("stop", &TrackerBinding::stop)
      .def("done", &TrackerBinding::done)
      .def("counts", [](const TrackerBinding& tracker) { return toPython(tracker.counts()); });
  module.def("wait_for_leaving", &TrackerBinding::waitForLeaving);
}

}  // namespace motorcade::python
