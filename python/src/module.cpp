#include <exception>
#include <string>

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"
#include "python/src/recording_binding.hpp"
#include "python/src/tracker_binding.hpp"

namespace py = pybind11;

namespace motorcade::python {
namespace {

/// Raises the package's own Error. Its text puts the field before the message, as `what` does.
void raise(const Error& error) {
  const std::string text = error.what();
  const auto type = py::module_::import("motorcade._error").attr("Error");
  PyErr_SetObject(type.ptr(), type(error.field(), text.substr(error.field().size() + 2)).ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    raise(error);
  }
}

}  // namespace
}  // namespace motorcade::python

PYBIND11_MODULE(_motorcade, module) {
  module.doc() = "What the package motorcade stands on; use that.";
  py::register_exception_translator(&motorcade::python::translate);
  motorcade::python::bindTracker(module);
  motorcade::python::bindRecording(module);
  module.def("version", &motorcade::version);
}
