#include "python/src/result_output.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <pybind11/numpy.h>

namespace py = pybind11;
using namespace py::literals;

namespace motorcade::python {
namespace {

py::object packaged(const char* type) { return py::module_::import("motorcade._results").attr(type); }

/// The package's enumerations have the library's order and names.
template <class Enum, std::size_t count>
py::object enumOf(const char* type, const std::array<const char*, count>& names, Enum value) {
  return packaged(type)(names.at(static_cast<std::size_t>(value)));
}

py::object pythonOf(Result::Status status) { return enumOf("Status", std::array{"good", "lost", "rejected"}, status); }

py::object pythonOf(Result::Cause cause) {
  constexpr std::array kNames{"none",   "after_gap", "few_points",   "no_points", "unlinked",
                              "failed", "unusable",  "out_of_order", "too_late"};
  return enumOf("Cause", kNames, cause);
}

py::object pythonOf(Result::State state) {
  return enumOf("State", std::array{"moving", "stopped", "predicted"}, state);
}

py::object pythonOf(Result::Kind kind) {
  return enumOf("Kind", std::array{"unknown", "car", "large_vehicle", "two_wheeler", "pedestrian"}, kind);
}

template <std::size_t size>
py::array_t<double> vectorOf(const std::array<double, size>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(size), values.data());
}

template <std::size_t size>
py::array_t<double> squareOf(const std::array<double, size>& values) {
  constexpr py::ssize_t kSide = size == 36 ? 6 : 3;
  static_assert(kSide * kSide == size);
  return py::array_t<double>({kSide, kSide}, values.data());
}

py::object squareOf(const std::optional<std::array<double, 36>>& values) {
  return values ? py::object(squareOf(*values)) : py::none();
}

/// Adds the row 0 0 0 1, so that transforms can be multiplied and inverted.
py::array_t<double> transformOf(const std::array<double, 12>& rows) {
  std::array<double, 16> whole{};
  std::copy(rows.begin(), rows.end(), whole.begin());
  whole.back() = 1;
  return py::array_t<double>({4, 4}, whole.data());
}

py::object pythonOf(const std::optional<Result::Mask>& mask) {
  if (!mask) return py::none();
  py::array_t<bool> inside({mask->height_cells, mask->width_cells});
  std::transform(mask->inside.begin(), mask->inside.end(), inside.mutable_data(),
                 [](std::uint8_t cell) { return cell != 0; });
  return packaged("Mask")("left_px"_a = mask->left_px, "top_px"_a = mask->top_px, "cell_px"_a = mask->cell_px,
                          "inside"_a = inside);
}

/// None where there is none.
py::object memberOf(const std::optional<Result::Acceleration>& acceleration, double Result::Acceleration::*member) {
  return acceleration ? py::object(py::float_((*acceleration).*member)) : py::none();
}

py::object pythonOf(const Result::Object& object) {
  using Acceleration = Result::Acceleration;
  const auto acceleration = [&](double Acceleration::*member) { return memberOf(object.acceleration, member); };
  return packaged("Object")(
      "id"_a = object.id, "state"_a = pythonOf(object.state), "T_world_body"_a = transformOf(object.T_world_body),
      "T_cam_body"_a = transformOf(object.T_cam_body), "covariance"_a = squareOf(object.covariance),
      "velocity_world_mps"_a = vectorOf(object.velocity_world_mps),
      "velocity_covariance"_a = squareOf(object.velocity_covariance), "yaw_rate_radps"_a = object.yaw_rate_radps,
      "yaw_rate_sigma_radps"_a = object.yaw_rate_sigma_radps,
      "acceleration_mps2"_a = acceleration(&Acceleration::along_mps2),
      "acceleration_sigma_mps2"_a = acceleration(&Acceleration::along_sigma_mps2),
      "yaw_acceleration_radps2"_a = acceleration(&Acceleration::yaw_radps2),
      "yaw_acceleration_sigma_radps2"_a = acceleration(&Acceleration::yaw_sigma_radps2), "age_s"_a = object.age_s,
      "points"_a = object.points, "image_box_px"_a = vectorOf(object.image_box_px),
      "box_center_body_m"_a = vectorOf(object.box_center_body_m), "box_size_m"_a = vectorOf(object.box_size_m),
      "box_size_sigma_m"_a = vectorOf(object.box_size_sigma_m),
      "box_center_sigma_m"_a = vectorOf(object.box_center_sigma_m), "kind"_a = pythonOf(object.kind),
      "kind_probability"_a = object.kind_probability, "existence_probability"_a = object.existence_probability,
      "mask"_a = pythonOf(object.mask));
}

py::tuple pythonOf(const std::vector<Result::Object>& objects) {
  py::tuple all(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) all[i] = pythonOf(objects[i]);
  return all;
}

}  // namespace

py::object toPython(const Result& result) {
  return packaged("Result")(
      "frame"_a = result.frame, "stamp_ns"_a = result.stamp_ns, "status"_a = pythonOf(result.status),
      "cause"_a = pythonOf(result.cause), "segment"_a = result.segment,
      "T_world_cam"_a = transformOf(result.T_world_cam), "pose_covariance"_a = squareOf(result.pose_covariance),
      "motion_covariance"_a = squareOf(result.motion_covariance), "velocity"_a = vectorOf(result.velocity),
      "velocity_covariance"_a = squareOf(result.velocity_covariance), "objects"_a = pythonOf(result.objects),
      "dropped_before"_a = result.dropped_before, "latency_ms"_a = result.latency_ms, "problem"_a = result.problem);
}

py::object toPython(const Tracker::Push& push) {
  const auto status = enumOf("PushStatus", std::array{"accepted", "replaced_older", "rejected"}, push.status);
  return packaged("Push")(status, push.why);
}

py::object toPython(const Tracker::Counts& counts) {
  return packaged("Counts")("pushed"_a = counts.pushed, "rejected"_a = counts.rejected, "dropped"_a = counts.dropped,
                            "results"_a = counts.results, "untaken"_a = counts.untaken);
}

py::object toPython(Tracker::LogLevel level) {
  return enumOf("LogLevel", std::array{"info", "warning", "error"}, level);
}

}  // namespace motorcade::python
