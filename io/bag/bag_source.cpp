#include "io/bag/bag_source.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

/// Mosaics become gray when the message is decoded.
Sequence withoutMosaic(Sequence sequence) {
  sequence.bayer.reset();
  return sequence;
}

}  // namespace

BagSource::BagSource(const BagDrive& drive, const Params& params)
    : name_(drive.sequence.name()),
      conversion_(drive.conversion),
      params_(params),
      pairs_(drive.sequence.folder, drive.topics, BagPairs::Infos::kLeaveOut),
      reader_(withoutMosaic(drive.sequence)),
      ring_(params.ahead) {
  thread_ = std::jthread([this] {
    try {
      end_ = readAll();
    } catch (const std::exception& problem) {  // nothing may leave the thread
      end_ = {problem.what(), true};
    }
    ring_.close();
  });
}

BagSource::~BagSource() { stop(); }

void BagSource::stop() {
  pairs_.bag().stop();
  ring_.close();
}

SourceEnd BagSource::finish() {
  stop();
  thread_.join();
  return end_;
}

Timestamp BagSource::stampOf(FrameId frame) const {
  const std::lock_guard lock(mutex_);
  return stamps_[static_cast<std::size_t>(frame.value)];
}

SourceEnd BagSource::readAll() {
  for (std::size_t index = 0; index < params_.range.end; ++index) {
    std::optional<BagPair> pair;
    try {
      pair = pairs_.next();
    } catch (const InputError& damage) {
      return endAfter(index, damage.what());
    }
    if (!pair) return pairs_.bag().stopped() ? SourceEnd{} : endAfter(index, "");
    {
      const std::lock_guard lock(mutex_);
      stamps_.push_back({pair->left.stamp_ns});
    }
    if (index >= params_.range.begin && !give(index, *pair)) break;
  }
  return {};
}

SourceEnd BagSource::endAfter(std::size_t pairs, const std::string& damage) const {
  const std::string count = std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs");
  const bool none = pairs <= params_.range.begin;
  if (!damage.empty()) return {damage + "; " + count + " came before", none};
  if (none) return {name_ + ": the bag ends after " + count + ", before the first of --frames", true};
  return {pairs_.remark(), false};
}

/// False where no further pair is wanted.
bool BagSource::give(std::size_t index, const BagPair& pair) {
  if (params_.wanted && !params_.wanted({pair.left.stamp_ns})) return !ring_.closed();
  return ring_.push(decode(index, pair));
}

StereoFrame BagSource::decode(std::size_t index, const BagPair& pair) {
  const auto start = std::chrono::steady_clock::now();
  StereoFrame frame;
  frame.head = {.frame = {static_cast<std::int64_t>(index)}, .stamp = {pair.left.stamp_ns}};
  frame.inputs = params_.inputs;
  try {
    frame.left = reader_.prepared(pair.left.gray(pool_, conversion_), StereoSide::kLeft);
    frame.right = reader_.prepared(pair.right.gray(pool_, conversion_), StereoSide::kRight);
  } catch (const std::exception& error) {  // a lack of memory only costs the frame
    frame.reject(FrameCause::kUnusable, error.what());
  }
  frame.decoded = std::chrono::steady_clock::now();
  frame.decode_ms = std::chrono::duration<double, std::milli>(frame.decoded - start).count();
  return frame;
}

}  // namespace motorcade
