#include "python/src/recording_binding.hpp"

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <string>

#include <pybind11/numpy.h>

#include "motorcade/motorcade.hpp"
#include "python/src/camera_input.hpp"

namespace py = pybind11;

namespace motorcade::python {
namespace {

/// A recorded drive as Python holds it. Any thread may use it, and its pairs own their pixels.
class RecordingBinding {
 public:
  explicit RecordingBinding(const std::string& folder) : recording_(folder) {}
  py::object camera() const { return toPython(recording_.camera()); }
  std::int64_t size() const { return recording_.size(); }
  py::object read(std::int64_t index);

 private:
  std::mutex reading_;  // taken without the GIL
  Recording recording_;
};

/// None where there are no pixels. Recordings are read as 8-bit gray.
py::object imageOf(const Pair::Image& image) {
  if (image.pixels == nullptr) return py::none();
  py::array_t<std::uint8_t> copy({image.height_px, image.width_px});
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += image.stride_bytes)
    std::copy_n(row, image.width_px, copy.mutable_data(y, 0));
  return copy;
}

py::object RecordingBinding::read(std::int64_t index) {
  std::unique_lock lock(reading_, std::defer_lock);
  Pair pair;
  {
    const py::gil_scoped_release release;
    lock.lock();
    pair = recording_.read(index);
  }
  return py::module_::import("motorcade._recording")
      .attr("Pair")(imageOf(pair.left), imageOf(pair.right), pair.stamp_ns, pair.frame);
}

}  // namespace

void bindRecording(py::module_& module) {
  py::class_<RecordingBinding>(module, "Recording")
      .def(py::init<const std::string&>(), py::call_guard<py::gil_scoped_release>())
      .def("camera", &RecordingBinding::camera)
      .def("size", &RecordingBinding::size)
      .def("read", &RecordingBinding::read);
}

}  // namespace motorcade::python
