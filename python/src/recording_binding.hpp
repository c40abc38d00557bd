#pragma once

#include <pybind11/pybind11.h>

namespace motorcade::python {

/// Adds the class `Recording` to the module.
void bindRecording(pybind11::module_& module);

}  // namespace motorcade::python
