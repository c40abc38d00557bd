#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/console/child_process.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// Path of the `ffmpeg` in PATH; empty where there is none.
std::optional<std::filesystem::path> findFfmpeg();

/// Throws UsageError unless the name ends in .mp4 (H.264) or .webm (VP9).
void requireVideoName(const std::filesystem::path& file);

/// Hands pictures to ffmpeg, which makes a video of them. The video is written beside the file and replaces it in the
/// end. Failures are OutputErrors with ffmpeg's own words.
class VideoWriter {
 public:
  struct Format {
    ImageSize size;
    double rate_hz;
  };
  /// Once `stop` is set, nothing waits any more.
  VideoWriter(const std::filesystem::path& file, const Format& format, const std::filesystem::path& ffmpeg,
              const std::atomic<bool>& stop);
  /// Ends ffmpeg and removes what it wrote, unless `finish` was called.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// All pictures have the size of the format.
  void write(const RgbImage& picture);
  void finish();

 private:
  [[noreturn]] void fail(const std::string& what);

  std::filesystem::path file_, partial_;
  ImageSize size_;
  const std::atomic<bool>& stop_;
  std::optional<FileDescriptor> pictures_;
  ChildOutput words_;  // of ffmpeg
  std::optional<ChildProcess> process_;
};

}  // namespace motorcade
