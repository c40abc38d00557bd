#include "folder_camera.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>

namespace vehicle_stack {
namespace {

std::vector<std::uint8_t> copyOf(const motorcade::Pair::Image& image) {
  if (image.pixels == nullptr) return {};
  std::vector<std::uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px));
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += image.stride_bytes)
    pixels.insert(pixels.end(), row, row + image.width_px);
  return pixels;
}

/// False when a stop was asked for before.
bool sleepUntil(std::chrono::steady_clock::time_point due, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  wake.wait_until(lock, stop, due, [] { return false; });
  return !stop.stop_requested();
}

}  // namespace

FolderCamera::FolderCamera(const std::string& folder, const Params& params, const std::function<bool()>& give_up)
    : params_(params), period_ns_(static_cast<std::int64_t>(1e9 / params.rate_hz)) {
  motorcade::Recording drive(folder);
  camera_ = drive.camera();
  const std::int64_t pairs = std::min(drive.size(), params.most_pairs);
  for (std::int64_t i = 0; i < pairs && !give_up(); ++i) {
    const motorcade::Pair pair = drive.read(i);
    frames_.push_back({.left = copyOf(pair.left), .right = copyOf(pair.right), .stamp_ns = pair.stamp_ns});
  }
}

std::optional<motorcade::Pair> FolderCamera::next(const std::stop_token& stop) {
  if (!start_) start_ = Clock::now();
  while (next_tick_ < ticks()) {
    const std::int64_t tick = next_tick_++;
    if (!sleepUntil(*start_ + std::chrono::nanoseconds(tick * period_ns_), stop)) return std::nullopt;
    if (!stalledIn(tick)) return pairOf(tick);
  }
  return std::nullopt;
}

motorcade::Pair FolderCamera::pairOf(std::int64_t tick) const {
  const auto& frame = frames_[static_cast<std::size_t>(tick) % frames_.size()];
  return {.left = view(frame.left), .right = view(frame.right), .stamp_ns = stampOf_ns(tick), .frame = tick};
}

motorcade::Pair::Image FolderCamera::view(const std::vector<std::uint8_t>& pixels) const {
  if (pixels.empty()) return {};
  return {.pixels = pixels.data(), .width_px = camera_.width_px, .height_px = camera_.height_px};
}

/// A drive that begins anew goes on one mean step after its end.
std::int64_t FolderCamera::stampOf_ns(std::int64_t tick) const {
  if (params_.stamps == Stamps::kRemade) return tick * period_ns_;
  const auto frames = static_cast<std::int64_t>(frames_.size());
  const std::int64_t duration_ns = frames_.back().stamp_ns - frames_.front().stamp_ns;
  const std::int64_t step_ns = frames > 1 ? duration_ns / (frames - 1) : period_ns_;
  return frames_[static_cast<std::size_t>(tick % frames)].stamp_ns + tick / frames * (duration_ns + step_ns);
}

bool FolderCamera::stalledIn(std::int64_t tick) const {
  const double time_s = static_cast<double>(tick * period_ns_) * 1e-9;
  return time_s >= params_.stall_at_s && time_s < params_.stall_at_s + params_.stall_for_s;
}

std::int64_t FolderCamera::ticks() const { return static_cast<std::int64_t>(frames_.size()) * params_.loops; }

}  // namespace vehicle_stack
