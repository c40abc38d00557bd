#pragma once

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"

namespace motorcade::python {

/// Converts to the package's dataclasses. The caller holds the GIL.
pybind11::object toPython(const Result& result);
pybind11::object toPython(const Tracker::Push& push);
pybind11::object toPython(const Tracker::Counts& counts);
pybind11::object toPython(Tracker::LogLevel level);

}  // namespace motorcade::python
