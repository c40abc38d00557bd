#include <string>

#include "apps/interface/c_interface_output.hpp"
#include "apps/interface/c_interface_structs.hpp"

using namespace motorcade;

namespace motorcade {
namespace {

const Result::Object& objectAt(const motorcade_result* from, std::size_t index) {
  require(from, "result");
  const auto& objects = from->result.objects;
  if (index >= objects.size())
    throw Error("index", "is " + std::to_string(index) + " of " + std::to_string(objects.size()) + " objects");
  return objects[index];
}

}  // namespace
}  // namespace motorcade

motorcade_code motorcade_result_frame(const motorcade_result* result, motorcade_frame* frame) {
  return guarded([&] {
    require(result, "result");
    requireStruct(frame, "frame");
    writeStruct(frameOf(result->result), frame);
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_result_object(const motorcade_result* result, size_t index, motorcade_object* object) {
  return guarded([&] {
    requireStruct(object, "object");
    writeStruct(objectOf(objectAt(result, index)), object);
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_result_mask(const motorcade_result* result, size_t index, motorcade_mask* mask) {
  return guarded([&] {
    requireStruct(mask, "mask");
    const auto& found = objectAt(result, index).mask;
    writeStruct(found ? maskOf(*found) : motorcade_mask{}, mask);
    return found ? MOTORCADE_OK : MOTORCADE_NONE;
  });
}

void motorcade_result_release(motorcade_result* result) { delete result; }
