#pragma once

#include <optional>
#include <string>

#include <pybind11/pybind11.h>

#include "motorcade/motorcade.hpp"

namespace motorcade::python {

/// The order of colors by its name, "rgb" or "bgr". Throws Error.
Pair::Format colorFormatOf(const std::string& name);

/// An image of Python's in the library's form, taken by the buffer protocol without a copy. Holds the buffer while it
/// lives; created and destroyed with the GIL.
class ImageInput {
 public:
  /// None is an image without pixels. Without `color_format` the image holds labels instead of colors. Throws TypeError
  /// or ValueError, which call the image `name` and say how to mend it.
  ImageInput(const pybind11::object& image, const std::string& name, std::optional<Pair::Format> color_format);
  const Pair::Image& view() const { return view_; }

 private:
  pybind11::buffer_info buffer_;
  Pair::Image view_;
};

}  // namespace motorcade::python
