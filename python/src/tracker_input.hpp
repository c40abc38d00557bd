#pragma once

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"

namespace motorcade::python {

/// A tracker's options from keyword arguments, without those that are callbacks. Throws TypeError or Error, which name
/// the option as the library does, `options.threads`.
Tracker::Options optionsOf(const pybind11::kwargs& options);

}  // namespace motorcade::python
