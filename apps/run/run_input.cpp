#include "apps/run/run_input.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include <unistd.h>

#include "apps/inject/fault_spec.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/bag_source.hpp"
#include "io/files/errors.hpp"
#include "io/inputs/instance_source.hpp"
#include "io/inputs/sequence_decoder.hpp"
#include "io/inputs/vehicle_motion.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/timestamps.hpp"
#include "io/stream/y4m_source.hpp"

namespace motorcade {
namespace {

StereoPacking packingOf(const RunOptions& options) {
  if (options.side_by_side == options.over_under)
    throw UsageError(
        "-: say where a picture of the stream has the two images: --side-by-side (left | right) or --over-under (left "
        "above right)");
  return options.side_by_side ? StereoPacking::kSideBySide : StereoPacking::kOverUnder;
}

/// Throws UsageError for options that need a whole drive where pairs come one by one. `input` is the user's.
void refuseOneByOne(const RunOptions& options, const std::string& input) {
  if (!options.camera_poses.empty())
    throw UsageError("--camera-poses: needs a pose for each frame, and nobody knows how many " + input +
                     " has; give a folder of images");
  for (const Fault& fault : parseFaultSpec(options.inject).faults)
    if (fault.kind == FaultKind::kTruncated || fault.kind == FaultKind::kBitFlips)
      throw UsageError("--inject: faults of files (truncated, bitflips) need a file for each image, and " + input +
                       " has none");
}

/// Throws UsageError for options that a stream cannot serve.
void refuseForStream(const RunOptions& options, InputPolicy policy) {
  if (options.given.empty())
    throw UsageError(
        "-: a stream brings no calibration: give --camera fx,fy,cx,cy,baseline of a rectified pair, or --calibration "
        "FILE");
  refuseOneByOne(options, "a stream");
  if (policy == InputPolicy::kLive && !options.rate.empty())
    throw UsageError("--rate " + options.rate +
                     ": with --live, the program that writes the stream sets its pace (of "
                     "ffmpeg, by -re)");
  if (::isatty(STDIN_FILENO) == 1)
    throw UsageError(std::string("-: the standard input is a terminal; pipe a stream into it, as by") + kY4mCommand);
}

/// The user's rate takes precedence over the stream's.
double streamRate_hz(const RunOptions& options, const Y4mHeader& header) {
  if (options.fps_hz) return *options.fps_hz;
  if (header.rate_hz) return *header.rate_hz;
  throw UsageError("-: the stream's header tells no rate (F); give --fps HZ");
}

RunInput openStream(const RunOptions& options, InputPolicy policy) {
  refuseForStream(options, policy);
  const StereoPacking packing = packingOf(options);
  const FrameRange range = options.frames.empty() ? FrameRange{} : parseFrameRange(options.frames);
  auto stream = std::make_unique<Y4mStream>(STDIN_FILENO, "standard input");
  RunInput input{.sequence = sequenceOfStream(stream->header(), packing, options.given), .range = range};
  input.capture_rate_hz = streamRate_hz(options, stream->header());
  input.rate_hz = policy == InputPolicy::kLive ? input.capture_rate_hz : replayRate_hz(options, policy);
  input.first_stamp = stampAtRate(static_cast<std::int64_t>(range.begin), input.capture_rate_hz);
  input.stream = std::move(stream);
  input.packing = packing;
  return input;
}

double meanRate_hz(const Sequence& sequence, const FrameRange& range, double fallback_hz) {
  if (range.size() < 2) return fallback_hz;
  return static_cast<double>(range.size() - 1) /
         secondsBetween(sequence.stamps[range.begin], sequence.stamps[range.end - 1]);
}

void refuseForFiles(const RunOptions& options) {
  if (options.side_by_side || options.over_under)
    throw UsageError(std::string(options.side_by_side ? "--side-by-side" : "--over-under") +
                     ": tells of a stream on the standard input; write - in place of the sequence");
}

void refuseTopics(const RunOptions& options) {
  if (!options.topics.empty())
    throw UsageError("--topics: tells of a bag (FILE.mcap, FILE.db3, or a folder of rosbag2), and " +
                     options.sequence.string() + " is none");
}

RunInput openBagDriveOf(const RunOptions& options, InputPolicy policy) {
  refuseForFiles(options);
  refuseOneByOne(options, "a bag");
  const FrameRange range = options.frames.empty() ? FrameRange{} : parseFrameRange(options.frames);
  BagDrive drive = openBagDrive(options.sequence, options.topics, options.given);
  RunInput input{.sequence = drive.sequence, .range = range};
  input.capture_rate_hz = drive.rate_hz;
  input.rate_hz = replayRate_hz(options, policy);
  if (input.rate_hz && options.rate.empty()) input.rate_hz = drive.rate_hz;
  input.first_stamp = drive.first;
  input.bag = std::move(drive);
  return input;
}

RunInput openRecorded(const RunOptions& options, InputPolicy policy) {
  refuseForFiles(options);
  const auto rate_hz = replayRate_hz(options, policy);
  RunInput input{.sequence = openSequence(options.sequence, options.fps(), options.given), .rate_hz = rate_hz};
  input.range = selectedFrames(options.frames, input.sequence);
  input.capture_rate_hz = meanRate_hz(input.sequence, input.range, options.fps());
  input.first_stamp = input.sequence.stamps[input.range.begin];
  return input;
}

/// Leaves out pairs of a live camera that a later one has overtaken, where decoding is too slow.
std::function<bool(Timestamp)> wantedPairs(const PipelineConfig& config, const std::optional<CameraClock>& clock) {
  if (!clock || config.pipeline.policy != InputPolicy::kLive) return {};
  return [&clock](Timestamp stamp) { return !clock->overtaken(stamp, std::chrono::steady_clock::now()); };
}

std::unique_ptr<PairSource> makeBagSource(const RunInput& input, const PipelineConfig& config, std::size_t ahead,
                                          const FrameInputs& inputs, const std::optional<CameraClock>& clock) {
  const BagSource::Params params{
      .range = input.range, .ahead = ahead, .wanted = wantedPairs(config, clock), .inputs = inputs};
  return std::make_unique<BagSource>(*input.bag, params);
}

std::unique_ptr<PairSource> makeRecorded(const RunInput& input, const PipelineConfig& config, std::size_t ahead,
                                         const FrameInputs& inputs, const std::optional<CameraClock>& clock) {
  const SequenceDecoder::Params decoding{
      .ahead = ahead, .wanted = wantedPairs(config, clock), .max_file_mb = config.input.max_file_mb, .inputs = inputs};
  return std::make_unique<SequenceDecoder>(input.sequence, input.range, decoding);
}

RunInput openPairs(const RunOptions& options, InputPolicy policy) {
  if (isBag(options.sequence)) return openBagDriveOf(options, policy);
  refuseTopics(options);
  return options.sequence == kStandardInput ? openStream(options, policy) : openRecorded(options, policy);
}

/// The file of the vehicle's own motion; empty where there is none.
std::filesystem::path motionFileOf(const RunOptions& options) {
  if (options.vehicle_motion == kNoVehicleMotion) return {};
  if (!options.vehicle_motion.empty()) return options.vehicle_motion;
  const std::filesystem::path beside = options.sequence / kVehicleMotionFile;
  return std::filesystem::exists(beside) ? beside : std::filesystem::path{};
}

std::unique_ptr<PairSource> makePairs(RunInput& input, const PipelineConfig& config, const FrameInputs& inputs,
                                      const std::optional<CameraClock>& clock) {
  const std::size_t ahead = std::bit_floor(static_cast<std::size_t>(config.pipeline.frames_in_flight));
  if (input.bag) return makeBagSource(input, config, ahead, inputs, clock);
  if (!input.sequence.streamed()) return makeRecorded(input, config, ahead, inputs, clock);
  const Y4mSource::Params params{.packing = input.packing,
                                 .range = input.range,
                                 .rate_hz = input.capture_rate_hz,
                                 .newest = input.writerPaced(config.pipeline.policy),
                                 .ahead = ahead,
                                 .inputs = inputs};
  return std::make_unique<Y4mSource>(std::move(input.stream), input.sequence, params);
}

}  // namespace

RunInput openRunInput(const RunOptions& options, InputPolicy policy) {
  RunInput input = openPairs(options, policy);
  const std::filesystem::path motion = motionFileOf(options);
  if (!motion.empty()) input.vehicle_motion = readVehicleMotion(motion, input.sequence);
  input.instances = options.instances;
  const StereoCamera& camera = input.sequence.camera;
  if (!input.instances.empty()) requireInstances(input.instances, camera.width_px, camera.height_px);
  return input;
}

std::optional<CameraClock> clockOf(const RunInput& input, InputPolicy policy) {
  if (!input.rate_hz || input.writerPaced(policy)) return std::nullopt;
  return std::make_optional<CameraClock>(*input.rate_hz / input.capture_rate_hz, 1 / input.capture_rate_hz);
}

std::unique_ptr<PairSource> makeSource(RunInput& input, const PipelineConfig& config, const FrameInputs& inputs,
                                       const std::optional<CameraClock>& clock) {
  auto pairs = makePairs(input, config, inputs, clock);
  const StereoCamera& camera = input.sequence.camera;
  if (!input.instances.empty())
    pairs = std::make_unique<InstanceSource>(std::move(pairs), input.instances, camera.width_px, camera.height_px);
  if (input.vehicle_motion.empty()) return pairs;
  return std::make_unique<VehicleMotionSource>(std::move(pairs), input.vehicle_motion);
}

}  // namespace motorcade
