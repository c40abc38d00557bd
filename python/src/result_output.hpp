#pragma once

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"

namespace motorcade::python {

/// As the package's dataclasses. The GIL is held.
pybind11::object toPython(const Result& result);
pybind11::object toPython(const Tracker::Push& push);
pybind11::object toPython(const Tracker::Counts& counts);
pybind11::object toPython(Tracker::LogLevel level);

}  // namespace motorcade::python
