#include "python/src/camera_input.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "python/src/python_value.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace motorcade::python {
namespace {

template <class Value>
void read(const py::object& object, const char* key, const std::string& name, Value& value) {
  const std::string field = name + "." + key;
  if (!py::hasattr(object, key))
    throw py::type_error(name + ": is a " + std::string(py::str(py::type::of(object).attr("__name__"))) + " without " +
                         key + "; describe it with motorcade's Camera, Rig and Lens");
  value = valueOf<Value>(object.attr(key), field);
}

/// Converts to an array of doubles, row by row.
py::array_t<double> arrayOf(const py::object& object, const std::string& field) {
  auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(object);
  if (!numbers) throw py::type_error(field + ": is no array of numbers");
  return numbers;
}

Camera::Distortion distortionOf(const py::object& lens, const std::string& name) {
  std::string model;
  read(lens, "distortion", name, model);
  if (model == "none") return Camera::Distortion::kNone;
  if (model == "radial_tangential") return Camera::Distortion::kRadialTangential;
  if (model == "equidistant") return Camera::Distortion::kEquidistant;
  throw Error(name + ".distortion", "is '" + model + "'; it is 'none', 'radial_tangential' or 'equidistant'");
}

template <class Intrinsics>
void readIntrinsics(const py::object& object, const std::string& name, Intrinsics& intrinsics) {
  read(object, "fx_px", name, intrinsics.fx_px);
  read(object, "fy_px", name, intrinsics.fy_px);
  read(object, "cx_px", name, intrinsics.cx_px);
  read(object, "cy_px", name, intrinsics.cy_px);
}

Camera::Lens lensOf(const py::object& object, const std::string& name) {
  Camera::Lens lens;
  readIntrinsics(object, name, lens);
  lens.distortion = distortionOf(object, name);
  const std::string field = name + ".coefficients";
  const auto coefficients = arrayOf(object.attr("coefficients"), field);
  if (coefficients.ndim() != 1 || coefficients.size() > static_cast<py::ssize_t>(lens.coefficients.size()))
    throw Error(field, "are not a sequence of at most eight numbers");
  std::copy_n(coefficients.data(), coefficients.size(), lens.coefficients.begin());
  return lens;
}

std::array<double, 12> transformOf(const py::object& object, const std::string& field) {
  const auto rows = arrayOf(object, field);
  if (rows.ndim() != 2 || rows.shape(1) != 4 || (rows.shape(0) != 3 && rows.shape(0) != 4))
    throw Error(field, "is no matrix of 3x4 or 4x4");
  constexpr std::array<double, 4> kLastRow{0, 0, 0, 1};
  if (rows.shape(0) == 4 && !std::equal(kLastRow.begin(), kLastRow.end(), rows.data(3, 0)))
    throw Error(field, "does not have 0 0 0 1 in its last row");
  std::array<double, 12> transform{};
  std::copy_n(rows.data(), transform.size(), transform.begin());
  return transform;
}

Camera::Rig rigOf(const py::object& object) {
  py::object left, right, transform;
  read(object, "left", "camera.rig", left);
  read(object, "right", "camera.rig", right);
  read(object, "T_right_left", "camera.rig", transform);
  return {.left = lensOf(left, "camera.rig.left"),
          .right = lensOf(right, "camera.rig.right"),
          .T_right_left = transformOf(transform, "camera.rig.T_right_left")};
}

Camera::Sigmas sigmasOf(const py::object& object) {
  Camera::Sigmas sigmas;
  const std::string name = "camera.sigmas";
  read(object, "focal", name, sigmas.focal);
  read(object, "middle_px", name, sigmas.middle_px);
  read(object, "distortion", name, sigmas.distortion);
  read(object, "baseline", name, sigmas.baseline);
  read(object, "disparity_px", name, sigmas.disparity_px);
  return sigmas;
}

/// The mask row by row, in the images' size.
std::vector<std::uint8_t> maskOf(const py::object& object, const Camera& camera) {
  const auto mask = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>::ensure(object);
  if (!mask) throw py::type_error("camera.ignored: is no array of numbers");
  if (mask.ndim() != 2 || mask.shape(0) != camera.height_px || mask.shape(1) != camera.width_px)
    throw Error("camera.ignored", "has another shape than the images, " + std::to_string(camera.height_px) +
                                      " rows of " + std::to_string(camera.width_px));
  return {mask.data(), mask.data() + mask.size()};
}

}  // namespace

Camera cameraOf(const py::object& object) {
  Camera camera;
  read(object, "width_px", "camera", camera.width_px);
  read(object, "height_px", "camera", camera.height_px);
  readIntrinsics(object, "camera", camera);
  read(object, "baseline_m", "camera", camera.baseline_m);
  py::object rig;
  read(object, "rig", "camera", rig);
  if (!rig.is_none()) camera.rig = rigOf(rig);
  py::object ignored;
  read(object, "ignored", "camera", ignored);
  if (!ignored.is_none()) camera.ignored.mask = maskOf(ignored, camera);
  py::object sigmas;
  read(object, "sigmas", "camera", sigmas);
  if (!sigmas.is_none()) camera.sigmas = sigmasOf(sigmas);
  return camera;
}

py::object toPython(const Camera& camera) {
  const auto described = py::module_::import("motorcade._camera");
  py::object sigmas = py::none();
  if (const auto& known = camera.sigmas)
    sigmas = described.attr("Sigmas")("focal"_a = known->focal, "middle_px"_a = known->middle_px,
                                      "distortion"_a = known->distortion, "baseline"_a = known->baseline,
                                      "disparity_px"_a = known->disparity_px);
  return described.attr("Camera")("width_px"_a = camera.width_px, "height_px"_a = camera.height_px,
                                  "fx_px"_a = camera.fx_px, "fy_px"_a = camera.fy_px, "cx_px"_a = camera.cx_px,
                                  "cy_px"_a = camera.cy_px, "baseline_m"_a = camera.baseline_m, "sigmas"_a = sigmas);
}

}  // namespace motorcade::python
