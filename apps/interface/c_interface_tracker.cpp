#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "apps/interface/c_interface_input.hpp"
#include "apps/interface/c_interface_output.hpp"
#include "apps/interface/c_interface_structs.hpp"

struct motorcade_tracker {  // NOLINT(readability-identifier-naming): a name of the C interface
  motorcade::Tracker tracker;
};

namespace motorcade {
namespace {

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
    return MOTORCADE_OK;
  });
}

void motorcade_tracker_destroy(motorcade_tracker* tracker) { delete tracker; }

motorcade_code motorcade_tracker_push(motorcade_tracker* tracker, const motorcade_pair* pair, motorcade_push* push) {
  return guarded([&] {
    require(tracker, "tracker");
    requireStruct(push, "push");
    writeStruct(pushOf(tracker->tracker.push(pairOf(pair))), push);
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_push_motion(motorcade_tracker* tracker, const motorcade_vehicle_motion* motion,
                                             motorcade_push* push) {
  return guarded([&] {
    require(tracker, "tracker");
    requireStruct(push, "push");
    writeStruct(pushOf(tracker->tracker.push_motion(motionOf(motion))), push);
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_close(motorcade_tracker* tracker) {
  return guarded([&] {
    require(tracker, "tracker");
    tracker->tracker.close();
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_reset(motorcade_tracker* tracker) {
  return guarded([&] {
    require(tracker, "tracker");
    tracker->tracker.reset();
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_poll(motorcade_tracker* tracker, motorcade_result** result) {
  return give(tracker, result, [](Tracker& from) { return from.poll(); });
}

motorcade_code motorcade_tracker_wait(motorcade_tracker* tracker, int64_t timeout_ms, motorcade_result** result) {
  return give(tracker, result,
              [timeout_ms](Tracker& from) { return from.wait(std::chrono::milliseconds(timeout_ms)); });
}

motorcade_code motorcade_tracker_done(const motorcade_tracker* tracker, bool* done) {
  return guarded([&] {
    require(tracker, "tracker");
    require(done, "done");
    *done = tracker->tracker.done();
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_on_result(motorcade_tracker* tracker, motorcade_take take, void* user) {
  return guarded([&] {
    require(tracker, "tracker");
    tracker->tracker.on_result(takerOf(take, user));
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_on_final(motorcade_tracker* tracker, motorcade_take take, void* user) {
  return guarded([&] {
    require(tracker, "tracker");
    tracker->tracker.on_final(takerOf(take, user));
    return MOTORCADE_OK;
  });
}

motorcade_code motorcade_tracker_counts(const motorcade_tracker* tracker, motorcade_counts* counts) {
  return guarded([&] {
    require(tracker, "tracker");
    requireStruct(counts, "counts");
    writeStruct(countsOf(tracker->tracker.counts()), counts);
    return MOTORCADE_OK;
  });
}
