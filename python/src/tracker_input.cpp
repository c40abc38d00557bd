#include "python/src/tracker_input.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <pybind11/stl.h>

#include "python/src/python_value.hpp"

namespace py = pybind11;

namespace motorcade::python {
namespace {

template <class Value>
Value optionOf(const py::kwargs& options, const char* key) {
  return valueOf<Value>(options[key], std::string("options.") + key);
}

Tracker::Policy policyOf(const std::string& name) {
  if (name == "live") return Tracker::Policy::kLive;
  if (name == "replay") return Tracker::Policy::kReplay;
  throw Error("options.policy", "is '" + name + "'; it is 'live' or 'replay'");
}

Tracker::Axes axesOf(const std::string& name) {
  if (name == "optical") return Tracker::Axes::kOptical;
  if (name == "rep103") return Tracker::Axes::kRep103;
  throw Error("options.axes", "are '" + name + "'; they are 'optical' or 'rep103'");
}

std::chrono::milliseconds patienceOf(double patience_s) {
  constexpr double kYear_s = 365 * 24 * 3600;
  if (!(patience_s >= 0 && patience_s <= kYear_s))
    throw Error("options.patience_s", "is " + std::to_string(patience_s) + "; it is from 0 to a year");
  return std::chrono::milliseconds(static_cast<std::int64_t>(1000 * patience_s));
}

}  // namespace

Tracker::Options optionsOf(const py::kwargs& given) {
  Tracker::Options options;
  options.policy = policyOf(optionOf<std::string>(given, "policy"));
  options.axes = axesOf(optionOf<std::string>(given, "axes"));
  options.masks = optionOf<bool>(given, "masks");
  options.threads = optionOf<int>(given, "threads");
  options.realtime_priority = optionOf<int>(given, "realtime_priority");
  options.cpus = optionOf<std::vector<int>>(given, "cpus");
  options.patience = patienceOf(optionOf<double>(given, "patience_s"));
  options.covariance_frames = optionOf<int>(given, "covariance_frames");
  options.settings = optionOf<std::string>(given, "settings");
  return options;
}

}  // namespace motorcade::python
