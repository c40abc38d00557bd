#include "python/src/callback.hpp"

namespace py = pybind11;

namespace motorcade::python {
namespace {

thread_local int callbacks_under_way = 0;

/// Counts a thread as in a callback, also while it releases what the callback held.
class Stay {
 public:
  Stay() { ++callbacks_under_way; }
  ~Stay() { --callbacks_under_way; }
  Stay(const Stay&) = delete;
  Stay& operator=(const Stay&) = delete;
};

}  // namespace

Callback::Callback(const py::object& callable)
    : callable_(new py::weakref(callable), [](const py::weakref* reference) {
        const py::gil_scoped_acquire gil;
        delete reference;
      }) {}

void Callback::operator()(const std::function<py::tuple()>& arguments) const {
  const Stay stay;
  const py::gil_scoped_acquire gil;
  const py::object callable = (*callable_)();
  if (callable.is_none()) return;
  try {
    callable(*arguments());
  } catch (py::error_already_set& error) {
    error.discard_as_unraisable(callable);
  }
}

bool Callback::isUnderWay() { return callbacks_under_way > 0; }

}  // namespace motorcade::python
