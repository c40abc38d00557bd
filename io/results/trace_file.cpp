#include "io/results/trace_file.hpp"

#include <chrono>
#include <string_view>
#include <utility>

#include "io/files/number_text.hpp"
#include "io/results/frame_table.hpp"

namespace motorcade {
namespace {

/// Workers of the arena are threads 0, 1, ...; the others have numbers that no worker has.
constexpr int kDecoder = 1000, kCamera = 1001;

/// Shorter waits are the hand-over itself.
constexpr double kShownWait_ms = 0.02;

SteadyTime middleOf(const StageSpan& span) { return span.start + (span.end - span.start) / 2; }

std::string inQuotes(std::string_view text) { return std::string("\"").append(text).append("\""); }

bool entered(const FrameTiming& timing) { return timing.head.status != FrameStatus::kDropped; }

std::string threadName(int thread) {
  if (thread == kDecoder) return "decoding ahead";
  if (thread == kCamera) return "camera";
  return "worker " + std::to_string(thread);
}

}  // namespace

TraceFile::TraceFile(const std::filesystem::path& file) : file_(file) { file_.writeLine("["); }

/// The text of an event without its end, which `add` writes.
std::string TraceFile::event(std::string_view name, char phase, int thread, SteadyTime at) const {
  std::string text;
  text.reserve(160);
  text.append(R"({"name":)").append(inQuotes(name)).append(R"(,"ph":")").append(1, phase).append(R"(","pid":1,"tid":)");
  appendInteger(text, thread);
  text.append(R"(,"ts":)");
  appendFixed(text, 1e3 * millisecondsBetween(*origin_, at), 3);
  return text;
}

void TraceFile::add(const std::string& event) { lines_.append(event).append("},\n"); }

/// Writes all lines of a frame at once: each is whole, also when the run is killed.
void TraceFile::write(const FrameTiming& timing) {
  if (!origin_) origin_ = timing.due;
  lines_.clear();
  nameThreads(timing);
  addMark(timing);
  if (entered(timing)) {
    addWork(timing);
    addWaits(timing);
    addArrows(timing);
    addInFlight(timing);
    before_ = timing;
  }
  if (lines_.empty()) return;
  lines_.pop_back();
  file_.writeLine(lines_);
}

void TraceFile::nameThreads(const FrameTiming& timing) {
  const auto name = [this](int thread) {
    if (thread < 0 || !named_.insert(thread).second) return;
    add(event("thread_name", 'M', thread, *origin_) + R"(,"args":{"name":)" + inQuotes(threadName(thread)) + "}");
  };
  for (const StageSpan& span : timing.stages) name(span.worker);
  if (timing.decode_ms > 0) name(kDecoder);
  name(kCamera);
}

void TraceFile::addWork(const FrameTiming& timing) {
  const auto work = [&](std::string_view name, int thread, SteadyTime start, double duration_ms) {
    std::string text = event(name, 'X', thread, start) + R"(,"dur":)";
    appendFixed(text, 1e3 * duration_ms, 3);
    add(text + R"(,"args":{"frame":)" + std::to_string(timing.head.frame.value) + "}");
  };
  if (timing.decoded != SteadyTime{}) {
    const auto taken = std::chrono::duration<double, std::milli>(timing.decode_ms);
    work("decode", kDecoder, timing.decoded - std::chrono::duration_cast<SteadyTime::duration>(taken),
         timing.decode_ms);
  }
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    const StageSpan& span = timing.stages[stage];
    if (span.ran()) work(kStageKeys[stage], span.worker, span.start, span.duration_ms());
  }
}

/// Adds a frame's path and its waits. They overlap with those of the next frame, which only asynchronous events can
/// show.
void TraceFile::addWaits(const FrameTiming& timing) {
  const std::string id = R"(,"id":)" + std::to_string(timing.head.frame.value);
  const auto from_to = [&](std::string_view category, std::string_view name, SteadyTime from, SteadyTime to) {
    const std::string tail = R"(,"cat":)" + inQuotes(category) + id;
    add(event(name, 'b', 0, from) + tail);
    add(event(name, 'e', 0, to) + tail);
  };
  from_to("frame", "frame", timing.due, timing.published);
  if (timing.entry_wait_ms() >= kShownWait_ms) from_to("queue", "wait: admit", timing.due, timing.admitted);
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const auto stage = static_cast<Stage>(i);
    if (timing.wait_ms(stage) >= kShownWait_ms)
      from_to("queue", std::string("wait: ").append(kStageKeys[i]), timing.handedTo(stage), timing.of(stage).start);
  }
}

void TraceFile::addArrows(const FrameTiming& timing) {
  const auto arrow = [this](std::string_view category, char phase, const StageSpan& span, FrameId frame) {
    std::string text = event(category, phase, span.worker, middleOf(span)) + R"(,"cat":)" + inQuotes(category) +
                       R"(,"id":)" + std::to_string(frame.value);
    add(phase == 's' ? text : text + R"(,"bp":"e")");
  };
  const auto path = pathOver(Stage::kOpticalFlow);
  for (const Stage stage : path) {
    const char phase = stage == path.front() ? 's' : stage == path.back() ? 'f' : 't';
    if (timing.of(stage).ran()) arrow("way of a frame", phase, timing.of(stage), timing.head.frame);
  }
  if (!before_ || !timing.of(Stage::kOpticalFlow).ran() || !before_->of(Stage::kOpticalFlow).ran()) return;
  arrow("frame to frame", 's', before_->of(Stage::kOpticalFlow), timing.head.frame);
  arrow("frame to frame", 'f', timing.of(Stage::kOpticalFlow), timing.head.frame);
}

/// Adds the number of frames in flight when this one enters the graph.
void TraceFile::addInFlight(const FrameTiming& timing) {
  std::erase_if(published_, [&](SteadyTime published) { return published <= timing.admitted; });
  published_.push_back(timing.published);
  add(event("frames in flight", 'C', 0, timing.admitted) + R"(,"args":{"frames":)" + std::to_string(published_.size()) +
      "}");
}

void TraceFile::addMark(const FrameTiming& timing) {
  if (timing.head.status == FrameStatus::kGood) return;
  add(event(statusName(timing.head.status), 'i', kCamera, timing.due) + R"(,"s":"t","args":{"frame":)" +
      std::to_string(timing.head.frame.value) + R"(,"cause":)" + inQuotes(causeName(timing.head.cause)) + "}");
}

void TraceFile::close() {
  // A metadata event closes the array without a comma, so that strict JSON readers accept a complete trace.
  file_.writeLine(R"({"name":"process_name","ph":"M","pid":1,"tid":0,"args":{"name":"motorcade"}})");
  file_.writeLine("]");
  file_.close();
}

}  // namespace motorcade
