#include "apps/draw/draw_command.hpp"

#include <algorithm>
#include <atomic>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "apps/console/stop_signals.hpp"
#include "apps/draw/video_writer.hpp"
#include "apps/draw/views.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/images/image_file.hpp"
#include "io/inputs/pair_reader.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Pictures per second, when every Nth frame of a drive is taken.
double rateOf(const RecordedDrive& drive, int every) {
  constexpr double kLeast_hz = 0.1, kMost_hz = 240, kUsual_hz = 10;
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < drive.stamps.size(); ++i)
    periods_s.push_back(secondsBetween(drive.stamps[i - 1], drive.stamps[i]));
  std::erase_if(periods_s, [](double period_s) { return !(period_s > 0); });
  if (periods_s.empty()) return kUsual_hz;
  const auto middle = periods_s.begin() + std::ssize(periods_s) / 2;
  std::ranges::nth_element(periods_s, middle);
  return std::clamp(1 / (*middle * every), kLeast_hz, kMost_hz);
}

/// The target of pictures: a folder or a video.
class Gallery {
 public:
  Gallery(const DrawOptions& options, double rate_hz, const std::atomic<bool>& stop)
      : folder_(options.out), file_(options.video), rate_hz_(rate_hz), stop_(stop) {
    if (!file_.empty()) {
      requireVideoName(file_);
      ffmpeg_ = findFfmpeg();
      if (!ffmpeg_) insteadOfVideo();
    }
    if (folder_.empty()) return;
    makeFolder(folder_);
  }

  void add(const RgbImage& picture, std::int64_t frame) {
    if (!folder_.empty()) writePngRgb(folder_ / fmt::format("frame_{:06}.png", frame), picture);
    if (ffmpeg_) {
      const VideoWriter::Format format{{picture.width, picture.height}, rate_hz_};
      if (!video_) video_ = std::make_unique<VideoWriter>(file_, format, *ffmpeg_, stop_);
      video_->write(picture);
    }
    ++pictures_;
  }

  void finish() {
    if (ffmpeg_ && !video_) throw InputError(file_.string() + ": is not written, as there is no frame to show");
    if (video_) video_->finish();
    if (!tellsProgress()) return;
    if (!folder_.empty()) std::cout << pictures_ << " pictures in " << folder_.string() << '\n';
    if (video_) std::cout << file_.string() << ": " << pictures_ << " pictures, " << pictures_ / rate_hz_ << " s\n";
  }

 private:
  void insteadOfVideo() {
    if (folder_.empty()) folder_ = fs::path(file_).replace_extension();
    std::cerr << "no ffmpeg is installed (Debian: apt-get install ffmpeg): pictures in " << folder_.string()
              << " instead of " << file_.string() << '\n';
  }

  fs::path folder_, file_;
  double rate_hz_;
  const std::atomic<bool>& stop_;
  std::optional<fs::path> ffmpeg_;
  std::unique_ptr<VideoWriter> video_;
  int pictures_ = 0;
};

/// Draws the wanted frames. One whose files cannot be read is reported and left out.
void drawAll(const DrawOptions& options, const Sequence& sequence, const RecordedDrive& drive,
             const std::atomic<bool>& stop, Gallery& gallery) {
  PairReader reader(sequence);
  for (std::size_t i = 0; i < drive.T_world_cam.size() && !stop; ++i) {
    const std::size_t frame = drive.first_frame + i;
    if (frame < options.frames.begin || frame >= options.frames.end ||
        (frame - options.frames.begin) % options.every != 0)
      continue;
    try {
      const DrawnImages images = readDrawnImages(sequence, frame, options.run, reader);
      gallery.add(drawFrame(images, drive, i), static_cast<std::int64_t>(frame));
    } catch (const InputError& problem) {
      std::cerr << "left out: " << problem.what() << '\n';
    }
  }
}

}  // namespace

int runDraw(const DrawOptions& options) {
  if (options.out.empty() && options.video.empty())
    throw UsageError("say where pictures go: --out FOLDER, --video FILE.mp4, or both");
  const RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  const RecordedDrive drive = recordedDrive(run, sequence);
  StopSignals signals;
  std::atomic<bool> stop = false;
  const std::jthread watching = signals.watch([&] { stop = true; });
  Gallery gallery(options, rateOf(drive, options.every), stop);
  drawAll(options, sequence, drive, stop, gallery);
  if (!stop) gallery.finish();
  if (!stop) return 0;
  std::cerr << "interrupted" << (options.video.empty() ? "" : ": " + options.video.string() + " is not written")
            << '\n';
  return kExitSignal + signals.received();
}

}  // namespace motorcade
