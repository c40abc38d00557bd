#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "apps/pipeline/configuration.hpp"
#include "apps/run/camera_clock.hpp"
#include "apps/run/run_command.hpp"
#include "core/messages.hpp"
#include "io/bag/bag_drive.hpp"
#include "io/inputs/pair_source.hpp"
#include "io/sequence/sequence.hpp"
#include "io/stream/stereo_packing.hpp"
#include "io/stream/y4m_stream.hpp"

namespace motorcade {

/// The input of a run as known before its first pair: a recorded drive, a stream or a bag.
struct RunInput {
  Sequence sequence;
  FrameRange range{};                                  // of a stream or bag without --frames it has no end
  double capture_rate_hz = 0;                          // mean over the range
  std::optional<double> rate_hz{};                     // at which pairs come; empty for as fast as it goes
  Timestamp first_stamp{};                             // of the range
  std::unique_ptr<Y4mStream> stream{};                 // null for all but a stream
  StereoPacking packing = StereoPacking::kSideBySide;  // of a stream
  std::optional<BagDrive> bag{};                       // of a bag
  std::vector<VehicleMotionSample> vehicle_motion{};   // samples by time; none where it is not known
  std::filesystem::path instances{};                   // a folder of instance labels; empty without

  /// True when the pairs come at their writer's pace, whether or not they are taken.
  bool writerPaced(InputPolicy policy) const { return sequence.piped() && policy == InputPolicy::kLive; }
  /// Number of pairs; 0 where it is not known before the end.
  std::size_t count() const { return range.end == FrameRange{}.end ? 0 : range.size(); }
};

/// Opens the user's input. For a stream it waits for the header, after it has refused what a stream cannot do. Throws
/// InputError or UsageError.
RunInput openRunInput(const RunOptions& options, InputPolicy policy);

/// The clock by which pairs are due; empty where they come as fast as possible, and where their writer has the clock.
std::optional<CameraClock> clockOf(const RunInput& input, InputPolicy policy);

/// Begins to decode the input's pairs; `inputs` come with each. The source takes the stream; `clock` must outlive it.
std::unique_ptr<PairSource> makeSource(RunInput& input, const PipelineConfig& config, const FrameInputs& inputs,
                                       const std::optional<CameraClock>& clock);

}  // namespace motorcade
