#pragma once

#include <functional>
#include <memory>

#include <pybind11/pybind11.h>

namespace motorcade::python {

/// A Python callable that a tracker's threads call. It is held weakly, so that Python's garbage collector can see what
/// it refers to: the tracker's Python object holds it, and once that is gone, a call does nothing.
class Callback {
 public:
  /// Of a callable that can be held weakly. The GIL is held.
  explicit Callback(const pybind11::object& callable);

  /// From any thread, without the GIL, which is held while `arguments` makes them. What the callable raises is printed.
  void operator()(const std::function<pybind11::tuple()>& arguments) const;

  /// Whether the calling thread is in a callback: such a thread must not wait for a tracker's end.
  static bool isUnderWay();

 private:
  std::shared_ptr<const pybind11::weakref> callable_;  // the last owner takes the GIL
};

}  // namespace motorcade::python
