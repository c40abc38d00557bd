#include "apps/run/run_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "apps/check/sequence_remarks.hpp"
#include "apps/console/log.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/stop_signals.hpp"
#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/run/camera_clock.hpp"
#include "apps/run/feeder.hpp"
#include "apps/run/given_knowledge.hpp"
#include "apps/run/mcap_recorder.hpp"
#include "apps/run/object_view_writer.hpp"
#include "apps/run/process_usage.hpp"
#include "apps/run/recorder.hpp"
#include "apps/run/run_input.hpp"
#include "apps/run/run_summary.hpp"
#include "apps/run/run_watch.hpp"
#include "apps/view/live_view.hpp"
#include "io/files/errors.hpp"
#include "io/inputs/pair_source.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {
namespace {

constexpr int kExitInput = 3, kExitUntracked = 5;

void logToSpdlog(LogLevel level, const std::string& text) {
  switch (level) {
    case LogLevel::kInfo:
      return logInfo(text);
    case LogLevel::kWarning:
      return logWarning(text);
    case LogLevel::kError:
      return logError(text);
  }
}

void requireReplaceable(const RunOptions& options) {
  if (!options.force && holdsFinishedRun(options.out))
    throw OutputError(options.out.string() +
                      ": holds a finished run; choose another folder, or replace it with --force");
}

void requireWithin(const ImageLimits& limits, const Sequence& sequence) {
  const int pixels = sequence.camera.width_px * sequence.camera.height_px;
  if (pixels > limits.max_pixels)
    throw InputError(
        fmt::format("{}: images of {} pixels, input.max_pixels is {}", sequence.name(), pixels, limits.max_pixels));
}

/// Considers the accuracy of the calibration. The user's values take precedence over the calibration's.
void considerCalibration(const Sequence& sequence, PipelineConfig& config) {
  CalibrationSigmas& sigmas = config.backend.window.calibration;
  if (sequence.calibration.sigmas && sigmas == CalibrationSigmas{}) sigmas = *sequence.calibration.sigmas;
}

/// Throws InputError where the calibration cannot be the images', unless the user insists.
void requireBelievable(const Sequence& sequence, bool force) {
  for (const std::string& doubt : doubtsAbout(sequence.camera)) {
    if (!force) throw InputError(sequence.name() + ": " + doubt + "; --force goes on");
    logWarning(doubt);
  }
}

/// Reports oddities of the images before the first of them is looked at. Throws InputError where results would be
/// worthless, unless the user insists.
void tellNotes(const Sequence& sequence, bool force) {
  for (const InputNote& note : sequence.notes) {
    if (note.worthless && !force) throw InputError(sequence.name() + ": " + note.text + "; --force goes on");
    logWarning(note.text);
  }
}

void announceRate(const RunInput& input, const RunOptions& options) {
  const Sequence& sequence = input.sequence;
  if (sequence.piped())
    logInfo(fmt::format("pairs are taken as {} Hz ({})", input.capture_rate_hz,
                        options.fps_hz ? "--fps" : "the stream's header"));
  else if (!sequence.stamps_measured)
    logInfo(fmt::format(
        "the sequence has no times: taken as {} Hz (--fps){}", options.fps(),
        sequence.numbering.step > 1
            ? fmt::format(" from one image to the next, whose numbers differ by {}", sequence.numbering.step)
            : ""));
}

void announce(const RunInput& input, const RunOptions& options) {
  const Sequence& sequence = input.sequence;
  logInfo(sequenceLine(sequence, input.range));
  if (sequence.samples) logInfo(fmt::format("16-bit images, {}", sequence.samples->why));
  if (sequence.bayer) logInfo(fmt::format("the images are mosaics of a color sensor, {}", nameOf(*sequence.bayer)));
  if (const auto doubt = mosaicDoubt(sequence, input.range, 1)) logWarning(*doubt);
  for (const std::string& oddity : odditiesOf(sequence.camera)) logWarning(oddity);
  announceRate(input, options);
  if (!input.vehicle_motion.empty())
    logInfo(fmt::format("the vehicle's own motion is known: {} samples", input.vehicle_motion.size()));
  if (!input.instances.empty()) logInfo("instance labels come from " + input.instances.string());
}

void tellOutside(double share) {
  constexpr double kTold = 0.02;
  if (share > kTold)
    logWarning(fmt::format(
        "{:.0f} % of a rectified image lies outside of what its camera saw: what is followed there is not real; "
        "calibrate with a projection that crops (alpha 0)",
        100 * share));
}

/// Input of the pipeline in a replay.
struct Replay {
  RunInput& input;
  FrameInputs inputs;  // come with each pair
  FaultInjector* faults = nullptr;
  InputWatch* watch = nullptr;
  RunListeners listeners{};
  LiveView* view = nullptr;
};

/// Lets the page ask for the pipeline's state as long as it lives.
class FollowedPipeline {
 public:
  FollowedPipeline(LiveView* view, const Pipeline& pipeline) : view_(view) {
    if (view_) view_->followPipeline([&pipeline] { return pipeline.state(); });
  }
  ~FollowedPipeline() {
    if (view_) view_->followPipeline({});
  }
  FollowedPipeline(const FollowedPipeline&) = delete;
  FollowedPipeline& operator=(const FollowedPipeline&) = delete;

 private:
  LiveView* view_;
};

/// Shows the run on a page, where the user wants that.
std::unique_ptr<LiveView> makeView(const RunOptions& options, const RunInput& input, const RunSummary& summary) {
  if (!options.shown) return nullptr;
  const auto first = static_cast<std::int64_t>(input.range.begin);
  const ShownRun run{.name = input.sequence.piped() ? input.sequence.name() : input.sequence.folder.filename().string(),
                     .folder = options.out.string(),
                     .can_pause = summary.params.policy != InputPolicy::kLive,
                     .first_frame = first,
                     .end_frame = first + static_cast<std::int64_t>(input.count()),
                     .first_stamp = input.first_stamp,
                     .rate_hz = summary.capture_rate_hz,
                     .paced = summary.rate_hz.has_value(),
                     .camera = input.sequence.camera};
  auto view = std::make_unique<LiveView>(parseListenAddress(options.view, "--view"), run, input.sequence);
  std::fprintf(stderr, "the page is at %s\n", view->url().c_str());
  return view;
}

RunSummary summaryBefore(const RunOptions& options, const PipelineConfig& config, const RunInput& input) {
  RunSummary summary;
  summary.params = config.pipeline;
  summary.setSequence(input.sequence);
  summary.ignored = options.ignored;
  summary.instances = options.instances.string();
  summary.inject = options.inject;
  summary.rate_hz = input.rate_hz;
  summary.capture_rate_hz = input.capture_rate_hz;
  return summary;
}

/// Adds a sentence about the source to the findings, unless it is empty.
void tellAtEnd(const char* name, const std::string& text, bool worthless, RunSummary& summary) {
  if (text.empty()) return;
  const FrameId after_last{summary.pipeline.received};
  summary.found.push_back(
      {.finding = {.name = name, .text = text, .worthless = worthless}, .last_good = {}, .first_bad = after_last});
  if (worthless)
    logError(text);
  else
    logWarning(text);
}

void tellEnd(const SourceEnd& end, RunSummary& summary) {
  tellAtEnd("stream", end.remark, end.damaged, summary);
  tellAtEnd("instances", end.instances, false, summary);
  summary.refused = summary.refused || end.damaged;
}

/// A replay waits for its files by intention; where a live run had to, its results are not what they could be.
void tellBehind(const WriteQueue::Load& writing, InputPolicy policy) {
  if (policy != InputPolicy::kLive || writing.views_left_out + writing.waits == 0) return;
  logWarning(fmt::format(
      "the disk was too slow: masks and points of {} frames are left out, {} results waited for their files, {:.1f} s "
      "in all",
      writing.views_left_out, writing.waits, writing.waited_s));
}

/// Runs the frames through the pipeline and writes all results but the summary.
void follow(const Replay& replay, const PipelineConfig& config, Stages stages, Recorder& recorder, RunSummary& summary,
            StopSignals& signals) {
  auto clock = clockOf(replay.input, config.pipeline.policy);
  const auto source = makeSource(replay.input, config, replay.inputs, clock);
  tellOutside(source->shareOutside());
  Pipeline pipeline(config.pipeline, std::move(stages), logToSpdlog);
  const auto start = std::chrono::steady_clock::now();
  {
    Feeder feeder(*source, pipeline,
                  {clock ? &*clock : nullptr, replay.faults, replay.watch, replay.listeners,
                   replay.view ? replay.view->gate() : nullptr});
    const FollowedPipeline followed(replay.view, pipeline);
    const auto watch = signals.watch([&feeder] { feeder.stop(); });
    while (auto result = pipeline.next()) recorder.record(*std::move(result));
  }
  PipelineEnd end = pipeline.finish();
  for (PipelineResult& result : end.results) recorder.record(std::move(result));
  recorder.recordRest(std::move(end.dropped), std::move(end.finals));
  summary.own_vehicle = recorder.finish();
  summary.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  summary.pipeline = end.summary;
  summary.good_frames = recorder.followed().count();
  summary.writing = recorder.writing();
  tellBehind(summary.writing, config.pipeline.policy);
  if (const auto& sensors = recorder.vehicleMotion().sensors())
    summary.vehicle_motion = {.found = *sensors,
                              .samples = static_cast<std::int64_t>(replay.input.vehicle_motion.size()),
                              .left_out = recorder.vehicleMotion().leftOut()};
  summary.signal = signals.received();
  summary.source_end = source->finish();
  summary.decoded = {"decode>input", static_cast<std::int64_t>(source->highWater()),
                     static_cast<std::int64_t>(source->capacity())};
}

/// Outputs that the user asked for beside the run folder's own files. They are opened before the run, so that errors
/// are known by then.
class ExtraOutputs {
 public:
  ExtraOutputs(const RunOptions& options, const StereoCamera& camera, InputPolicy policy) : mcap_file_(options.mcap) {
    ObjectViewWriter::removeEarlier(options.out);
    if (options.masks) views_.emplace(options.out, camera);
    if (options.mcap.empty()) return;
    using Behind = McapRecorder::Behind;
    mcap_.emplace(options.mcap, camera, policy == InputPolicy::kLive ? Behind::kLeaveOut : Behind::kWait);
  }

  RunListeners listeners() {
    RunListeners listeners;
    if (mcap_) listeners.push_back(&*mcap_);
    return listeners;
  }
  /// Null where the user wants none.
  ObjectViewWriter* views() { return views_ ? &*views_ : nullptr; }
  void close(RunSummary& summary) {
    if (views_) views_->close();
    if (mcap_) closeMcap(summary);
  }

 private:
  void closeMcap(RunSummary& summary) {
    mcap_->close();
    const auto [images, frames] = mcap_->leftOut();
    if (images + frames > 0)
      logWarning(fmt::format("{}: {} images and {} whole frames are left out, as writing was too slow",
                             mcap_file_.string(), images, frames));
    summary.mcap = {mcap_file_.string(), mcap_->bytes(), images, frames};
  }

  std::filesystem::path mcap_file_;
  std::optional<ObjectViewWriter> views_;
  std::optional<McapRecorder> mcap_;
};

/// The exit code for the run's outcome.
int exitCode(const RunSummary& summary, const FollowedFrames& followed, std::optional<double> required_tracking) {
  if (summary.refused) return kExitInput;
  if (summary.signal != 0) return kExitSignal + summary.signal;
  if (followed.none(summary.pipeline)) {
    logError(followed.whyNone(summary.pipeline));
    return kExitInput;
  }
  if (required_tracking && summary.trackedFraction() < *required_tracking) {
    logError(fmt::format("{:.4f} of the frames are tracked, --require asks for {:.4f}", summary.trackedFraction(),
                         *required_tracking));
    return kExitUntracked;
  }
  return 0;
}

}  // namespace

int runSequence(const RunOptions& options) {
  const ProcessUsage before = processUsage();
  PipelineConfig config = configurationOf(options);
  const auto required_tracking = requiredTracking(options);
  const FaultSpec fault_spec = parseFaultSpec(options.inject);
  requireReplaceable(options);
  RunInput input = openRunInput(options, config.pipeline.policy);
  const Sequence& sequence = input.sequence;
  considerCalibration(sequence, config);
  requireWithin(config.input, sequence);
  requireBelievable(sequence, options.force);
  tellNotes(sequence, options.force);
  const FrameInputs inputs{.ignored = sharedMask(ignoredPixels(options.ignored, sequence.camera))};
  Stages stages = makeStages(config, sequence.camera);
  if (auto other_camera = otherCamera(options, config, sequence)) replaceOdometry(stages, *std::move(other_camera));
  announce(input, options);
  logDebug(fmt::format("{} threads, {} frames in flight; results go to {}", config.pipeline.threads,
                       config.pipeline.frames_in_flight, options.out.string()));

  RunSummary summary = summaryBefore(options, config, input);
  StopSignals signals;  // before all threads
  const auto view = makeView(options, input, summary);
  RunFolderWriter folder(options.out);
  folder.writeConfig(toToml(config));
  ExtraOutputs extras(options, sequence.camera, config.pipeline.policy);
  RunListeners listeners = extras.listeners();
  if (view) listeners.push_back(view.get());
  Recorder recorder(ResultFiles(folder, extras.views(), fault_spec), WriteQueue::boundsOf(config.pipeline.policy),
                    listeners, input.count());
  FaultInjector faults(fault_spec, sequence);
  InputWatch watch(sequence.camera, options.force);
  follow({input, inputs, options.inject.empty() ? nullptr : &faults, &watch, listeners, view.get()}, config,
         std::move(stages), recorder, summary, signals);
  extras.close(summary);
  summary.found = watch.found();
  summary.refused = watch.refused();
  tellEnd(summary.source_end, summary);
  if (sequence.streamed()) summary.images.pairs = summary.pipeline.received;
  summary.used = processUsage().since(before);
  folder.finish(toJson(summary));
  if (tellsProgress()) std::fputs(shortReport(summary, options.out.string()).c_str(), stdout);
  return exitCode(summary, recorder.followed(), required_tracking);
}

}  // namespace motorcade
