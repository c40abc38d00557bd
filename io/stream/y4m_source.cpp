#include "io/stream/y4m_source.hpp"

#include <chrono>
#include <exception>
#include <string>
#include <utility>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/given_cameras.hpp"
#include "io/sequence/timestamps.hpp"

namespace motorcade {
namespace {

constexpr const char* kInterlaced =
    "its pictures are interlaced: every second row is of another moment; deinterlace them first, as by ffmpeg's -vf "
    "yadif";

/// None where the pictures are gray or have colors.
std::optional<BayerPattern> mosaicOfStream(const Sequence& sequence, const Y4mHeader& header) {
  const auto pattern = mosaicOf(sequence, sequence.given);
  if (pattern && header.chroma_samples > 0) throw InputError(sequence.name() + kNoMosaic);
  return pattern;
}

}  // namespace

Sequence sequenceOfStream(const Y4mHeader& header, StereoPacking packing, const GivenCameras& given) {
  Sequence sequence{.folder = kStandardInput};
  sequence.layout = packing == StereoPacking::kSideBySide ? "y4m_side_by_side" : "y4m_over_under";
  const ImageSize size = unpackedSize(header, packing, sequence.name());
  sequence.given = absolute(given);
  sequence.camera = givenCamera(sequence, sequence.given, size);
  sequence.camera.width_px = size.width;
  sequence.camera.height_px = size.height;
  if (header.bits > 8)
    sequence.samples = {header.bits, "taken as " + std::to_string(header.bits) + " bits: the stream's header tells so"};
  sequence.bayer = mosaicOfStream(sequence, header);
  if (header.interlaced) sequence.notes.push_back({.name = "images", .text = kInterlaced, .worthless = true});
  return sequence;
}

Y4mSource::Y4mSource(std::unique_ptr<Y4mStream> stream, const Sequence& sequence, const Params& params)
    : stream_(std::move(stream)),
      size_{sequence.camera.width_px, sequence.camera.height_px},
      params_(params),
      reader_(sequence),
      ring_(params.ahead) {
  thread_ = std::jthread([this] {
    try {
      end_ = readAll();
    } catch (const std::exception& problem) {  // nothing may leave the thread
      end_ = {problem.what(), true};
    }
    ring_.close();
    newest_.close();
  });
}

Y4mSource::~Y4mSource() { stop(); }

void Y4mSource::stop() {
  stream_->stop();
  ring_.close();
  newest_.close();
}

SourceEnd Y4mSource::finish() {
  stop();
  thread_.join();
  return end_;
}

Timestamp Y4mSource::stampOf(FrameId frame) const { return stampAtRate(frame.value, params_.rate_hz); }

SourceEnd Y4mSource::readAll() {
  for (std::size_t index = 0; index < params_.range.end; ++index) {
    const Y4mStream::Next next = stream_->next(luma_);
    if (next != Y4mStream::Next::kFrame) return endAfter(index, next);
    if (index >= params_.range.begin && !give(decode(index))) break;
  }
  return {};
}

SourceEnd Y4mSource::endAfter(std::size_t pairs, Y4mStream::Next why) const {
  if (why == Y4mStream::Next::kStopped) return {};
  const std::string count = std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs");
  if (why == Y4mStream::Next::kCutShort)
    return {stream_->name() + ": the stream ends within a picture, after " + count, pairs <= params_.range.begin};
  if (pairs > params_.range.begin) return {};
  return {stream_->name() + ": the stream ends after " + count + (pairs == 0 ? "" : ", before the first of --frames"),
          true};
}

/// False where no further pair is wanted.
bool Y4mSource::give(StereoFrame frame) {
  if (!params_.newest) return ring_.push(std::move(frame));
  newest_.put(std::move(frame));
  return !newest_.closed();
}

StereoFrame Y4mSource::decode(std::size_t index) {
  const auto came = std::chrono::steady_clock::now();
  StereoFrame frame;
  frame.head.frame = {static_cast<std::int64_t>(index)};
  frame.head.stamp = stampOf(frame.head.frame);
  frame.inputs = params_.inputs;
  try {
    ImagePair pair = unpacked(luma_, stream_->header().bits, params_.packing, size_, pool_);
    frame.left = reader_.prepared(std::move(pair.left), StereoSide::kLeft);
    frame.right = reader_.prepared(std::move(pair.right), StereoSide::kRight);
  } catch (const std::exception& error) {  // a lack of memory only costs the frame
    frame.reject(FrameCause::kUnusable, error.what());
  }
  frame.decoded = std::chrono::steady_clock::now();
  if (params_.newest) frame.due = frame.decoded;
  frame.decode_ms = std::chrono::duration<double, std::milli>(frame.decoded - came).count();
  return frame;
}

}  // namespace motorcade
