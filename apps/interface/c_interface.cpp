#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "apps/interface/c_interface_conversion.hpp"
#include "apps/interface/c_interface_structs.hpp"

struct motorcade_tracker {  // NOLINT(readability-identifier-naming): a name of the C interface
  motorcade::Tracker tracker;
};

struct motorcade_recording {  // NOLINT(readability-identifier-naming): a name of the C interface
  motorcade::Recording recording;
  motorcade_image left{}, right{};  // of the pair that was read last
};

namespace motorcade {
namespace {

/// Makes a call on the tracker of a handle.
template <class Handle, class Call>
motorcade_code with(Handle* tracker, const Call& call) {
  return guarded([&] {
    require(tracker, "tracker");
    call(tracker->tracker);
  });
}

/// Returns the result of `next`. The handle is created first, so that no result is lost if memory runs out.
template <class Next>
motorcade_code give(motorcade_tracker* from, motorcade_result** result, const Next& next) {
  return guarded([&] {
    require(result, "result");
    *result = nullptr;
    require(from, "tracker");
    auto handle = std::make_unique<motorcade_result>();
    std::optional<Result> taken = next(from->tracker);
    if (!taken) return from->tracker.done() ? MOTORCADE_DONE : MOTORCADE_NONE;
    handle->result = std::move(*taken);
    *result = handle.release();
    return MOTORCADE_OK;
  });
}

/// Empty where there is none.
std::function<void(Result)> takerOf(motorcade_take take, void* user) {
  if (take == nullptr) return {};
  return [take, user](Result result) {
    auto handle = std::make_unique<motorcade_result>();
    handle->result = std::move(result);
    take(handle.release(), user);
  };
}

const Result::Object& objectAt(const motorcade_result* from, std::size_t index) {
  require(from, "result");
  const auto& objects = from->result.objects;
  if (index >= objects.size())
    throw Error("index", "is " + std::to_string(index) + " of " + std::to_string(objects.size()) + " objects");
  return objects[index];
}

}  // namespace
}  // namespace motorcade

using namespace motorcade;

motorcade_code motorcade_pair_init(motorcade_pair* pair) { return initStruct(pair, "pair", defaultPair()); }

motorcade_code motorcade_options_init(motorcade_options* options) {
  return initStruct(options, "options", defaultOptions());
}

motorcade_code motorcade_tracker_create(const motorcade_camera* camera, const motorcade_options* options,
                                        motorcade_tracker** tracker) {
  return guarded([&] {
    require(tracker, "tracker");
    *tracker = nullptr;
    const Tracker::Options converted = options != nullptr ? optionsOf(options) : Tracker::Options{};
    *tracker = new motorcade_tracker{{cameraOf(camera), converted}};
  });
}

void motorcade_tracker_destroy(motorcade_tracker* tracker) { delete tracker; }

motorcade_code motorcade_tracker_push(motorcade_tracker* tracker, const motorcade_pair* pair, motorcade_push* push) {
  return with(tracker, [&](auto& following) {
    requireStruct(push, "push");
    writeStruct(pushOf(following.push(pairOf(pair))), push);
  });
}

motorcade_code motorcade_tracker_push_motion(motorcade_tracker* tracker, const motorcade_vehicle_motion* motion,
                                             motorcade_push* push) {
  return with(tracker, [&](auto& following) {
    requireStruct(push, "push");
    writeStruct(pushOf(following.push_motion(motionOf(motion))), push);
  });
}

motorcade_code motorcade_tracker_close(motorcade_tracker* tracker) {
  return with(tracker, [&](auto& following) { following.close(); });
}

motorcade_code motorcade_tracker_reset(motorcade_tracker* tracker) {
  return with(tracker, [&](auto& following) { following.reset(); });
}

motorcade_code motorcade_tracker_poll(motorcade_tracker* tracker, motorcade_result** result) {
  return give(tracker, result, [](Tracker& from) { return from.poll(); });
}

motorcade_code motorcade_tracker_wait(motorcade_tracker* tracker, int64_t timeout_ms, motorcade_result** result) {
  return give(tracker, result,
              [timeout_ms](Tracker& from) { return from.wait(std::chrono::milliseconds(timeout_ms)); });
}

motorcade_code motorcade_tracker_done(const motorcade_tracker* tracker, bool* done) {
  return with(tracker, [&](auto& following) {
    require(done, "done");
    *done = following.done();
  });
}

motorcade_code motorcade_tracker_on_result(motorcade_tracker* tracker, motorcade_take take, void* user) {
  return with(tracker, [&](auto& following) { following.on_result(takerOf(take, user)); });
}

motorcade_code motorcade_tracker_on_final(motorcade_tracker* tracker, motorcade_take take, void* user) {
  return with(tracker, [&](auto& following) { following.on_final(takerOf(take, user)); });
}

motorcade_code motorcade_tracker_counts(const motorcade_tracker* tracker, motorcade_counts* counts) {
  return with(tracker, [&](auto& following) {
    requireStruct(counts, "counts");
    writeStruct(countsOf(following.counts()), counts);
  });
}

motorcade_code motorcade_result_frame(const motorcade_result* result, motorcade_frame* frame) {
  return guarded([&] {
    require(result, "result");
    requireStruct(frame, "frame");
    writeStruct(frameOf(result->result), frame);
  });
}

motorcade_code motorcade_result_object(const motorcade_result* result, size_t index, motorcade_object* object) {
  return guarded([&] {
    requireStruct(object, "object");
    writeStruct(objectOf(objectAt(result, index)), object);
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

motorcade_code motorcade_recording_open(const char* folder, motorcade_recording** recording) {
  return guarded([&] {
    require(recording, "recording");
    *recording = nullptr;
    require(folder, "folder");
    *recording = new motorcade_recording{.recording = Recording(folder)};
  });
}

motorcade_code motorcade_recording_camera(const motorcade_recording* recording, motorcade_camera* camera) {
  return guarded([&] {
    require(recording, "recording");
    requireStruct(camera, "camera");
    writeStruct(cCameraOf(recording->recording.camera()), camera);
  });
}

motorcade_code motorcade_recording_size(const motorcade_recording* recording, int64_t* size) {
  return guarded([&] {
    require(recording, "recording");
    require(size, "size");
    *size = recording->recording.size();
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
