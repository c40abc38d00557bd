#include "python/src/image_input.hpp"

#include <algorithm>
#include <climits>
#include <cstddef>
#include <optional>

namespace py = pybind11;

namespace motorcade::python {
namespace {

std::string typeName(const py::object& object) { return py::str(py::type::of(object).attr("__name__")); }

py::buffer_info bufferOf(const py::object& image, const std::string& name) {
  if (!py::isinstance<py::buffer>(image))
    throw py::type_error(name + ": is a " + typeName(image) +
                         ", which has no buffer; hand in a numpy array: numpy.asarray(image)");
  return py::reinterpret_borrow<py::buffer>(image).request();
}

/// Names the element type as numpy does, or else by the buffer's format.
std::string elementName(const py::object& image, const py::buffer_info& buffer) {
  if (py::hasattr(image, "dtype")) return py::str(image.attr("dtype"));
  return "the buffer format '" + buffer.format + "'";
}

bool isUint16(const py::buffer_info& buffer) { return buffer.format == "H" || buffer.format == "<H"; }

constexpr const char* kMendOfImages =
    "image.astype(numpy.uint8), and where they are 0 to 1, (255 * image).astype(numpy.uint8)";
constexpr const char* kMendOfLabels = "labels.astype(numpy.uint16)";

void requireElement(const py::object& image, const std::string& name, const py::buffer_info& buffer,
                    const std::string& mend) {
  if (buffer.format == "B" || isUint16(buffer)) return;
  throw py::type_error(name + ": its pixels are " + elementName(image, buffer) +
                       ", not uint8 or uint16 in this machine's byte order; convert them: " + mend);
}

/// Empty where the shape is none of an image's.
std::optional<Pair::Format> formatOf(const py::buffer_info& buffer, std::optional<Pair::Format> color_format) {
  if (buffer.ndim == 2) return isUint16(buffer) ? Pair::Format::kGray16 : Pair::Format::kGray8;
  if (buffer.ndim == 3 && buffer.shape[2] == 3 && !isUint16(buffer)) return color_format;
  return std::nullopt;
}

std::string shapeText(const py::buffer_info& buffer) {
  py::tuple shape(buffer.shape.size());
  for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = buffer.shape[i];
  return py::str(shape);
}

/// Checks the strides. Rows may lie apart, but must not overlap; the pixels of a row must be contiguous.
void requireStrides(const std::string& name, const py::buffer_info& buffer) {
  const bool colors = buffer.ndim == 3;
  const py::ssize_t pixel_bytes = colors ? 3 : buffer.itemsize;
  if (buffer.strides[1] != pixel_bytes || (colors && buffer.strides[2] != 1))
    throw py::value_error(name +
                          ": the pixels of a row do not lie side by side; hand in a copy: "
                          "numpy.ascontiguousarray(image)");
  if (buffer.strides[0] < pixel_bytes * buffer.shape[1])
    throw py::value_error(name + ": its rows are " + std::to_string(buffer.strides[0]) +
                          " bytes apart, less than a row has, or upwards; hand in a copy: "
                          "numpy.ascontiguousarray(image)");
}

/// Clamps a side to the largest int. No camera has a side that long, so the library rejects it.
int sideOf_px(py::ssize_t pixels) { return static_cast<int>(std::min<py::ssize_t>(pixels, INT_MAX)); }

}  // namespace

Pair::Format colorFormatOf(const std::string& name) {
  if (name == "rgb") return Pair::Format::kRgb8;
  if (name == "bgr") return Pair::Format::kBgr8;
  throw Error("format", "is '" + name + "'; it is 'rgb' or 'bgr'");
}

ImageInput::ImageInput(const py::object& image, const std::string& name, std::optional<Pair::Format> color_format) {
  if (image.is_none()) return;
  buffer_ = bufferOf(image, name);
  requireElement(image, name, buffer_, color_format ? kMendOfImages : kMendOfLabels);
  const auto format = formatOf(buffer_, color_format);
  if (!format)
    throw py::value_error(name + ": has the shape " + shapeText(buffer_) +
                          (color_format ? "; images are (height, width), or of uint8 (height, width, 3)"
                                        : "; labels are (height, width)"));
  requireStrides(name, buffer_);
  view_ = {.pixels = buffer_.ptr,
           .width_px = sideOf_px(buffer_.shape[1]),
           .height_px = sideOf_px(buffer_.shape[0]),
           .stride_bytes = buffer_.strides[0],
           .format = *format};
}

}  // namespace motorcade::python
