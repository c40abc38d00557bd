#include "apps/interface/c_interface_input.hpp"
#include "apps/interface/c_interface_output.hpp"
#include "apps/interface/c_interface_structs.hpp"

struct motorcade_recording {  // NOLINT(readability-identifier-naming): a name of the C interface
  motorcade::Recording recording;
  motorcade_image left{}, right{};  // of the pair that was read last
};

using namespace motorcade;

motorcade_code motorcade_recording_open(const char* folder, motorcade_recording** recording) {
  return guarded([&] {
    require(recording, "recording");
    *recording = nullptr;
    require(folder, "folder");
    *recording = new motorcade_recording{.recording = Recording(folder)};
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_recording_camera(const motorcade_recording* recording, motorcade_camera* camera) {
  return guarded([&] {
    require(recording, "recording");
    requireStruct(camera, "camera");
    writeStruct(cCameraOf(recording->recording.camera()), camera);
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_recording_size(const motorcade_recording* recording, int64_t* size) {
  return guarded([&] {
    require(recording, "recording");
    require(size, "size");
    *size = recording->recording.size();
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_recording_read(motorcade_recording* recording, int64_t index, motorcade_pair* pair) {
  return guarded([&] {
    require(recording, "recording");
    requireStruct(pair, "pair");
    if (index >= recording->recording.size()) return MOTORCADE_DONE;
    const Pair read = recording->recording.read(index);
    recording->left = cImageOf(read.left);
    recording->right = cImageOf(read.right);
    writeStruct({.struct_size = 0,
                 .left = &recording->left,
                 .right = &recording->right,
                 .stamp_ns = read.stamp_ns,
                 .frame = read.frame,
                 .instances = nullptr},
                pair);
    return MOTORCADE_OK;
  });
}

void motorcade_recording_close(motorcade_recording* recording) { delete recording; }
