#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"

namespace motorcade::python {

/// A tracker as Python holds it. Every call is made with the GIL, which is released while the library works. Ctrl-C
/// ends a wait. The garbage collector may destroy it anywhere, also within a callback.
class TrackerBinding {
 public:
  /// `log` is None, or can be held weakly.
  TrackerBinding(const pybind11::object& camera, const pybind11::object& log, const pybind11::kwargs& options);
  ~TrackerBinding();
  TrackerBinding(const TrackerBinding&) = delete;
  TrackerBinding& operator=(const TrackerBinding&) = delete;

  Tracker::Push push(const Pair& pair);
  Tracker::Push pushMotion(const VehicleMotion& motion);
  std::optional<Result> poll();
  /// Waits forever if no timeout is given.
  std::optional<Result> wait(std::optional<double> timeout_s);
  bool done() const;
  /// `take` is None, or can be held weakly.
  void handTo(const pybind11::object& take);
  void handFinalsTo(const pybind11::object& take);
  /// True when results go to a callback.
  bool handsOn() const;
  Tracker::Counts counts() const;
  void close();
  void reset();

  /// Abandons what is in flight. On return, calls of other threads have come back and the tracker's threads have ended.
  /// Within a callback it returns at once, and a thread of its own ends the tracker.
  void stop();

  /// Returns when every thread that ends a tracker is through.
  static void waitForLeaving();

 private:
  struct Running;
  class Visit;
  static void end(std::unique_ptr<Running> running);
  static void endBehindTheScenes(std::unique_ptr<Running> running);

  std::unique_ptr<Running> running_;  // empty once it is stopped; guarded by the GIL
  Tracker::Counts last_counts_;
};

/// Adds the class `Tracker` to the module.
void bindTracker(pybind11::module_& module);

}  // namespace motorcade::python
