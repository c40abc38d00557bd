#pragma once

#include <functional>
#include <memory>

#include <pybind11/pybind11.h>

namespace motorcade::python {

/// A Python callable that a tracker's threads call. It is held weakly, so that Python's garbage collector can see what
/// it refers to. The tracker's Python object holds it; once that is gone, a call does nothing.
class Callback {
 public:
  /// Takes a callable that can be held weakly. The caller holds the GIL.
  explicit Callback(const pybind11::object& callable);

  /// Calls the callable from any thread, which must not hold the GIL; `arguments` runs with the GIL. Prints what the
  /// callable raises.
  void operator()(const std::function<pybind11::tuple()>& arguments) const;

  /// True while the calling thread is in a callback. Such a thread must not wait for a tracker's end.
  static bool isUnderWay();

 private:
  std::shared_ptr<const pybind11::weakref> callable_;  // the last owner takes the GIL
};

}  // namespace motorcade::python
