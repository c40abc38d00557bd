#include "apps/inject/fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>

#include <sys/resource.h>
#include <unistd.h>

#include "apps/inject/image_faults.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {
namespace {

std::uint64_t addressSpace_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Number of pairs that the faults reach back, at least one.
std::size_t reachOf(const FaultSpec& spec) {
  double most = 1;
  for (const Fault& fault : spec.faults)
    if (fault.kind == FaultKind::kApart) most = std::max(most, fault.value);
  return static_cast<std::size_t>(most);
}

// Limits of this process, like those of a small machine or a full disk. They cannot be taken back.

/// Lets no file grow beyond this size: a write fails as on a full disk.
void limitFileSize(std::uint64_t bytes) {
  const rlimit both{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &both);
}

/// Lets the address space grow by `bytes` and no more.
void limitFurtherMemory(std::uint64_t bytes) {
  const rlim_t limit = addressSpace_bytes() + bytes;
  const rlimit both{limit, limit};
  setrlimit(RLIMIT_AS, &both);
}

}  // namespace

FaultInjector::FaultInjector(FaultSpec spec, const Sequence& sequence)
    : spec_(std::move(spec)), sequence_(sequence), kept_(reachOf(spec_)) {}

bool FaultInjector::give(StereoFrame frame, const Outlet& outlet) {
  const Image right = frame.right;
  bool dropped = false;
  std::int64_t overtaken_by = 0;  // frames
  for (std::size_t k = 0; k < spec_.faults.size(); ++k) {
    const Fault& fault = spec_.faults[k];
    if (!strikes(fault, k, frame.head.frame, spec_.seed)) continue;
    if (fault.kind == FaultKind::kDrop) dropped = true;
    if (fault.kind == FaultKind::kLate) overtaken_by = static_cast<std::int64_t>(fault.value);
    if (fault.kind == FaultKind::kStall) outlet.wait(std::chrono::duration<double>(fault.value));
    applyTo(frame, fault, seedOf(spec_.seed, k, frame.head.frame));
  }
  left_before_ = frame.left;
  right_before_ = frame.right;
  rights_taken_.push_front(right);
  if (rights_taken_.size() > kept_) rights_taken_.pop_back();
  frame.head.stamp = shifted(frame.head.stamp);
  const std::int64_t id = frame.head.frame.value;
  if (dropped || overtaken_by > 0) outlet.pass_over(frame.head.frame, frame.head.stamp);
  if (overtaken_by > 0)
    late_.push_back({std::move(frame), id + overtaken_by});
  else if (!dropped && !outlet.push(std::move(frame)))
    return false;
  return giveLate(id, outlet);
}

bool FaultInjector::giveLate(std::int64_t frame, const Outlet& outlet) {
  const auto due =
      std::stable_partition(late_.begin(), late_.end(), [&](const Late& late) { return late.after > frame; });
  std::deque<Late> come(std::make_move_iterator(due), std::make_move_iterator(late_.end()));
  late_.erase(due, late_.end());
  return std::ranges::all_of(come, [&](Late& late) { return outlet.push(std::move(late.frame)); });
}

bool FaultInjector::finish(const Outlet& outlet) { return giveLate(std::numeric_limits<std::int64_t>::max(), outlet); }

void FaultInjector::applyTo(StereoFrame& frame, const Fault& fault, std::uint64_t seed) {
  switch (fault.kind) {
    case FaultKind::kDuplicate:
      if (!left_before_.empty()) frame.left = left_before_, frame.right = right_before_;
      return;
    case FaultKind::kApart:
      return takeEarlierRight(frame, static_cast<std::size_t>(fault.value));
    case FaultKind::kExchanged:
      return std::swap(frame.left, frame.right);
    case FaultKind::kTimeJump:
      jumps_ns_ += std::llround(1e9 * fault.value);
      return;
    case FaultKind::kOutOfMemory:
      return limitFurtherMemory(static_cast<std::uint64_t>(1e6 * fault.value));
    case FaultKind::kDiskFull:
      return limitFileSize(static_cast<std::uint64_t>(1e3 * fault.value));
    default:
      break;
  }
  if (frame.rejected()) return;
  const FrameId id = frame.head.frame;
  try {
    if (fault.side != FaultSide::kRight) applyTo(frame.left, {id, StereoSide::kLeft}, fault, 2 * seed);
    if (fault.side != FaultSide::kLeft) applyTo(frame.right, {id, StereoSide::kRight}, fault, 2 * seed + 1);
  } catch (const std::exception& error) {
    frame.reject(FrameCause::kUnusable, error.what());
  }
}

/// Replaces the right image by that of an earlier pair, or by the oldest while there are fewer. It stays while there is
/// none.
void FaultInjector::takeEarlierRight(StereoFrame& frame, std::size_t pairs_before) const {
  if (rights_taken_.empty()) return;
  const Image& right = rights_taken_[std::min(rights_taken_.size(), pairs_before) - 1];
  if (!right.empty()) frame.right = right;
}

Image FaultInjector::readAgain(const ImageOf& of, const std::function<std::string(std::string)>& damage) {
  if (!reader_) reader_.emplace(sequence_);
  const std::filesystem::path& file = sequence_.frames.at(static_cast<std::size_t>(of.frame.value)).of(of.side);
  return reader_->decode(damage(readImageBytes(file)), file, of.side);
}

void FaultInjector::applyTo(Image& image, const ImageOf& of, const Fault& fault, std::uint64_t seed) {
  constexpr std::uint8_t kBlack = 0, kWhite = 255;
  if (image.empty()) return;
  switch (fault.kind) {
    case FaultKind::kBlack:
    case FaultKind::kWhite:
      image = filled(image, fault.kind == FaultKind::kBlack ? kBlack : kWhite, pool_);
      break;
    case FaultKind::kBlur:
      image = blurred(image, fault.value, pool_);
      break;
    case FaultKind::kNoise:
      image = withNoise(image, fault.value, seed, pool_);
      break;
    case FaultKind::kExposure:
      image = exposed(image, fault.value, pool_);
      break;
    case FaultKind::kJpeg:
      image = throughJpeg(image, static_cast<int>(fault.value), pool_);
      break;
    case FaultKind::kLowered:
      image = lowered(image, fault.value, pool_);
      break;
    case FaultKind::kRolled:
      image = rolled(image, fault.value * std::numbers::pi / 180, pool_);
      break;
    case FaultKind::kZoomed:
      image = zoomed(image, 1 + fault.value / 100, pool_);
      break;
    case FaultKind::kBarrel:
      image = distorted(image, fault.value, pool_);
      break;
    case FaultKind::kTruncated:
      image = readAgain(of, [&](std::string bytes) {
        bytes.resize(static_cast<std::size_t>(fault.value * static_cast<double>(bytes.size())));
        return bytes;
      });
      break;
    case FaultKind::kBitFlips:
      image = readAgain(
          of, [&](std::string bytes) { return withBitFlips(std::move(bytes), static_cast<int>(fault.value), seed); });
      break;
    case FaultKind::kOneEyed:
      image = Image();
      break;
    default:
      break;
  }
}

}  // namespace motorcade
