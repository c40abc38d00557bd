#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "apps/draw/palette.hpp"
#include "apps/draw/views.hpp"
#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"

namespace motorcade {

DrawnImages readDrawnImages(const Sequence& sequence, std::size_t frame, const std::filesystem::path& run_folder,
                            PairReader& reader) {
  DrawnImages images{.left = reader.read(sequence.frames[frame], StereoSide::kLeft)};
  const auto mask = maskFile(run_folder / kMasksFolder, {static_cast<std::int64_t>(frame)});
  if (!std::filesystem::exists(mask)) return images;
  images.mask = readPng16(mask);
  const ImageSize size{images.mask->width, images.mask->height}, wanted{images.left.width(), images.left.height()};
  if (size != wanted)
    throw InputError(mask.string() + ": has " + size.text() + " pixels, the image has " + wanted.text());
  return images;
}

namespace {

constexpr int kBarHeight_px = 30;

/// Speed between the frames before and after, where both exist. NaN for a drive of fewer than two frames.
double cameraSpeed_mps(const RecordedDrive& drive, std::size_t frame) {
  const std::size_t from = frame > 0 ? frame - 1 : 0, to = std::min(frame + 1, drive.T_world_cam.size() - 1);
  const double dt_s = secondsBetween(drive.stamps[from], drive.stamps[to]);
  const auto way_m = (drive.T_world_cam[to].translation() - drive.T_world_cam[from].translation()).norm();
  return dt_s > 0 ? way_m / dt_s : std::nan("");
}

/// Draws run, frame and the own car's speed.
void drawBar(Canvas& canvas, const RecordedDrive& drive, std::size_t frame) {
  const TextStyle bold{.color = kInk, .size_px = 12.5, .bold = true}, plain{.color = kInk, .size_px = 12.5},
      dim{.color = kDimInk, .size_px = 11.5};
  constexpr double kEdge_px = 14, kSpace_px = 26, kBase_px = 19.5;
  double left = kEdge_px;
  const auto put = [&](const std::string& text, const TextStyle& style) {
    canvas.text({left, kBase_px}, text, style);
    left += Canvas::textWidth(text, style) + kSpace_px;
  };
  put(fmt::format("frame {}", drive.first_frame + static_cast<std::int64_t>(frame)), bold);
  if (frame < drive.stamps.size() && frame < drive.T_world_cam.size()) {
    put(fmt::format("{:.2f} s", secondsBetween(drive.stamps.front(), drive.stamps[frame])), plain);
    if (const double speed_mps = cameraSpeed_mps(drive, frame); std::isfinite(speed_mps))
      put(fmt::format("own car {:.1f} m/s", speed_mps), plain);
  }
  const double name = Canvas::textWidth(drive.name, dim);
  if (left + name < canvas.width() - kEdge_px)
    canvas.text({canvas.width() - kEdge_px - name, kBase_px}, drive.name, dim);
}

}  // namespace

RgbImage drawFrame(const DrawnImages& images, const RecordedDrive& drive, std::size_t frame) {
  const int width = images.left.width(), height = images.left.height(), top_height = std::max(220, width * 27 / 100),
            legend_height = legendHeight(width);
  Canvas canvas(width, height + kBarHeight_px + top_height + legend_height, kBar);
  canvas.paste(images.left, {0, 0, static_cast<double>(width), static_cast<double>(height)});
  Marks marks;
  Canvas image_part = canvas.part(0, 0, width, height);
  Sheet image_sheet{image_part, marks};
  paintImageView(image_sheet, images, drive, frame);
  Canvas bar = canvas.part(0, height, width, kBarHeight_px);
  drawBar(bar, drive, frame);
  Canvas top_part = canvas.part(0, height + kBarHeight_px, width, top_height);
  const double right = width, bottom = top_height;
  top_part.fill(std::vector<Eigen::Vector2d>{{-1, -1}, {right, -1}, {right, bottom}, {-1, bottom}}, {kBackdrop});
  Sheet top_sheet{top_part, marks};
  paintTopView(top_sheet, drive, frame);
  Canvas legend = canvas.part(0, height + kBarHeight_px + top_height, width, legend_height);
  drawLegend(legend, marks);
  return canvas.image();
}

}  // namespace motorcade
