#include "apps/run/run_input.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <string>
#include <utility>

#include <unistd.h>

#include "apps/inject/fault_spec.hpp"
#include "io/errors.hpp"
#include "io/sequence_decoder.hpp"
#include "io/stream/stream_sequence.hpp"
#include "io/stream/y4m_source.hpp"
#include "io/timestamps.hpp"
#include "io/vehicle_motion_file.hpp"
#include "io/vehicle_motion_source.hpp"

namespace motorcade {
namespace {

StereoPacking packingOf(const RunOptions& options) {
  if (options.side_by_side == options.over_under)
    throw UsageError(
        "-: say where a picture of the stream has the two images: --side-by-side (left | right) or --over-under (left "
        "above right)");
  return options.side_by_side ? StereoPacking::kSideBySide : StereoPacking::kOverUnder;
}

/// Throws UsageError for what a stream has not.
void refuseForStream(const RunOptions& options, InputPolicy policy) {
  if (options.given.empty())
    throw UsageError(
        "-: a stream brings no calibration: give --camera fx,fy,cx,cy,baseline of a rectified pair, or --calibration "
        "FILE");
  if (!options.camera_poses.empty())
    throw UsageError("--camera-poses: needs a pose for each frame, and nobody knows how many a stream has; record it");
  if (policy == InputPolicy::kLive && !options.rate.empty())
    throw UsageError("--rate " + options.rate +
                     ": with --live, the program that writes the stream sets its pace (of "
                     "ffmpeg, by -re)");
  for (const Fault& fault : parseFaultSpec(options.inject).faults)
    if (fault.kind == FaultKind::kTruncated || fault.kind == FaultKind::kBitFlips)
      throw UsageError("--inject: faults of files (truncated, bitflips) need files, and a stream has none");
  if (::isatty(STDIN_FILENO) == 1)
    throw UsageError(std::string("-: the standard input is a terminal; pipe a stream into it, as by") + kY4mCommand);
}

/// The user's rate comes before the stream's.
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

RunInput openRecorded(const RunOptions& options, InputPolicy policy) {
  if (options.side_by_side || options.over_under)
    throw UsageError(std::string(options.side_by_side ? "--side-by-side" : "--over-under") +
                     ": tells of a stream on the standard input; write - in place of the sequence");
  const auto rate_hz = replayRate_hz(options, policy);
  RunInput input{.sequence = openSequence(options.sequence, options.fps(), options.given), .rate_hz = rate_hz};
  input.range = selectedFrames(options.frames, input.sequence);
  input.capture_rate_hz = meanRate_hz(input.sequence, input.range, options.fps());
  input.first_stamp = input.sequence.stamps[input.range.begin];
  return input;
}

std::unique_ptr<PairSource> makeRecorded(const RunInput& input, const PipelineConfig& config, std::size_t ahead,
                                         const FrameInputs& inputs, const std::optional<CameraClock>& clock) {
  SequenceDecoder::Params decoding{.ahead = ahead, .max_file_mb = config.input.max_file_mb, .inputs = inputs};
  // Where decoding is too slow for a live camera, pairs that a later one has overtaken are left out.
  if (clock && config.pipeline.policy == InputPolicy::kLive)
    decoding.wanted = [&](Timestamp stamp) { return !clock->overtaken(stamp, std::chrono::steady_clock::now()); };
  return std::make_unique<SequenceDecoder>(input.sequence, input.range, decoding);
}

/// Of the vehicle's own motion; empty where there is none.
std::filesystem::path motionFileOf(const RunOptions& options) {
  if (options.vehicle_motion == kNoVehicleMotion) return {};
  if (!options.vehicle_motion.empty()) return options.vehicle_motion;
  const std::filesystem::path beside = options.sequence / kVehicleMotionFile;
  return std::filesystem::exists(beside) ? beside : std::filesystem::path{};
}

std::unique_ptr<PairSource> makePairs(RunInput& input, const PipelineConfig& config, const FrameInputs& inputs,
                                      const std::optional<CameraClock>& clock) {
  const std::size_t ahead = std::bit_floor(static_cast<std::size_t>(config.pipeline.frames_in_flight));
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
  RunInput input = options.sequence == kStandardInput ? openStream(options, policy) : openRecorded(options, policy);
  const std::filesystem::path motion = motionFileOf(options);
  if (!motion.empty()) input.vehicle_motion = readVehicleMotion(motion, input.sequence);
  return input;
}

std::optional<CameraClock> clockOf(const RunInput& input, InputPolicy policy) {
  if (!input.rate_hz || input.writerPaced(policy)) return std::nullopt;
  return std::make_optional<CameraClock>(*input.rate_hz / input.capture_rate_hz, 1 / input.capture_rate_hz);
}

std::unique_ptr<PairSource> makeSource(RunInput& input, const PipelineConfig& config, const FrameInputs& inputs,
                                       const std::optional<CameraClock>& clock) {
  auto pairs = makePairs(input, config, inputs, clock);
  if (input.vehicle_motion.empty()) return pairs;
  return std::make_unique<VehicleMotionSource>(std::move(pairs), input.vehicle_motion);
}

}  // namespace motorcade
