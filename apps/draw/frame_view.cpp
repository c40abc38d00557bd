#include "apps/draw/frame_view.hpp"

#include <algorithm>

#include "apps/draw/image_view.hpp"
#include "apps/draw/top_view.hpp"

namespace motorcade {

Canvas drawFrame(const DrawnImages& images, const RecordedDrive& run, std::size_t frame) {
  constexpr int kGap_px = 4;
  constexpr Color kBackground{17, 21, 27};
  const int width = images.left.width(), height = images.left.height();
  const int top_height = std::max(240, width * 3 / 10);
  Canvas canvas(width, height + kGap_px + top_height, kBackground);
  canvas.paste(drawImageView(images, run, frame), 0, 0);
  canvas.paste(drawTopView(run, frame, width, top_height), 0, height + kGap_px);
  return canvas;
}

}  // namespace motorcade
