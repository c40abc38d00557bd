#include "io/truth/ground_truth.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// Labels, and the objects that they tell of in a drive of a few frames.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kFrames = 20;
  static fuzz::MemoryFile file;
  Sequence sequence;
  sequence.truth.labels = file.holding(fuzz::textOf(data, size));
  CameraTruth camera;
  camera.T_world_cam.resize(kFrames);
  fuzz::readOrRefuse(sequence.truth.labels.native(), {}, [&] {
    const auto truths = readObjectTruths(sequence, camera);
    for (const ObjectTruth& truth : truths->objects) {
      fuzz::require(truth.frame.value >= 0 && truth.frame.value < std::ssize(camera.T_world_cam), "a frame too far");
      fuzz::require(truth.T_world_object.rotation().allFinite(), "an attitude that is not finite");
    }
    for (const Label& label : readLabels(sequence.truth.labels)) resultLine(label, 1);
  });
  return 0;
}
