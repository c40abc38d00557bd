#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <motorcade/motorcade.hpp>

/// Drives in memory, and trackers' results on them, by the public interface alone.
namespace motorcade {

/// A drive with its images in memory, without gaps between rows.
struct DriveInMemory {
  struct Frame {
    std::vector<std::uint8_t> left, right;
    std::int64_t stamp_ns = 0;
  };
  Camera camera;
  std::vector<Frame> frames;

  Pair::Image imageOf(const std::vector<std::uint8_t>& pixels) const {
    return {.pixels = pixels.data(), .width_px = camera.width_px, .height_px = camera.height_px};
  }
  Pair pair(std::size_t index) const {
    const Frame& frame = frames[index];
    return {.left = imageOf(frame.left), .right = imageOf(frame.right), .stamp_ns = frame.stamp_ns};
  }
};

inline std::vector<std::uint8_t> pixelsOf(const Pair::Image& image) {
  const auto width = static_cast<std::size_t>(image.width_px);
  std::vector<std::uint8_t> pixels(width * static_cast<std::size_t>(image.height_px));
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (std::size_t at = 0; at < pixels.size(); at += width, row += image.stride_bytes)
    std::memcpy(&pixels[at], row, width);
  return pixels;
}

inline DriveInMemory readDrive(const std::string& folder, std::int64_t most_frames = 1'000'000) {
  Recording recording(folder);
  DriveInMemory drive{.camera = recording.camera(), .frames = {}};
  for (std::int64_t index = 0; index < recording.size() && index < most_frames; ++index) {
    const Pair pair = recording.read(index);
    drive.frames.push_back({pixelsOf(pair.left), pixelsOf(pair.right), pair.stamp_ns});
  }
  return drive;
}

/// A drive that is small and without anything to see, so that a tracker is quick with it.
inline DriveInMemory blankDrive(std::size_t frames) {
  constexpr int kSide_px = 64;
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  DriveInMemory drive{.camera = {.width_px = kSide_px,
                                 .height_px = kSide_px,
                                 .fx_px = 60,
                                 .fy_px = 60,
                                 .cx_px = 32,
                                 .cy_px = 32,
                                 .baseline_m = 0.5},
                      .frames = {}};
  const std::vector<std::uint8_t> gray(std::size_t{kSide_px} * kSide_px, 128);
  for (std::size_t index = 0; index < frames; ++index)
    drive.frames.push_back({gray, gray, static_cast<std::int64_t>(index) * kPeriod_ns});
  return drive;
}

inline Tracker::Options replay(int threads = 2) {
  Tracker::Options options;
  options.policy = Tracker::Policy::kReplay;
  options.threads = threads;
  return options;
}

/// Results left, by `wait`, of a tracker that was closed or is going to be.
inline std::vector<Result> rest(Tracker& tracker) {
  std::vector<Result> results;
  while (auto result = tracker.wait(std::chrono::hours(1))) results.push_back(std::move(*result));
  return results;
}

/// All results of a drive, by replay unless `options` say otherwise.
inline std::vector<Result> track(const DriveInMemory& drive, const Tracker::Options& options = replay(),
                                 const std::function<Pair(std::size_t)>& pair_at = {}) {
  Tracker tracker(drive.camera, options);
  std::jthread producer([&] {
    for (std::size_t index = 0; index < drive.frames.size(); ++index)
      tracker.push(pair_at ? pair_at(index) : drive.pair(index));
    tracker.close();
  });
  return rest(tracker);
}

/// All that a result says, bit by bit, but for its latency.
class ResultBytes {
 public:
  static std::string of(const Result& result) {
    ResultBytes bytes;
    bytes.add(result.frame, result.stamp_ns, result.status, result.cause, result.segment, result.T_world_cam);
    bytes.addOptional(result.pose_covariance);
    bytes.addOptional(result.motion_covariance);
    bytes.add(result.velocity, result.velocity_covariance, result.dropped_before, result.objects.size());
    for (const Result::Object& object : result.objects) bytes.addObject(object);
    return bytes.text_ + result.problem;
  }

 private:
  template <class... Values>
  void add(const Values&... values) {
    (text_.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  }
  template <class Value>
  void addOptional(const std::optional<Value>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  void addObject(const Result::Object& o) {
    add(o.id, o.state, o.T_world_body, o.T_cam_body, o.velocity_world_mps, o.velocity_covariance, o.yaw_rate_radps);
    add(o.yaw_rate_sigma_radps, o.age_s, o.points, o.image_box_px, o.box_center_body_m, o.box_size_m);
    add(o.box_size_sigma_m, o.box_center_sigma_m, o.kind, o.kind_probability, o.existence_probability,
        o.mask.has_value());
    addOptional(o.covariance);
    addOptional(o.acceleration);
    if (!o.mask) return;
    add(o.mask->left_px, o.mask->top_px, o.mask->cell_px, o.mask->width_cells, o.mask->height_cells);
    text_.append(o.mask->inside.begin(), o.mask->inside.end());
  }
  std::string text_;
};

inline std::vector<std::string> bytesOf(const std::vector<Result>& results) {
  std::vector<std::string> bytes;
  for (const Result& result : results) bytes.push_back(ResultBytes::of(result));
  return bytes;
}

}  // namespace motorcade
