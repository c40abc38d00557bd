#pragma once

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"

namespace motorcade::python {

/// Converts the package's Camera to the library's, and back. Throws TypeError or Error, which name the field.
Camera cameraOf(const pybind11::object& camera);
pybind11::object toPython(const Camera& camera);

}  // namespace motorcade::python
