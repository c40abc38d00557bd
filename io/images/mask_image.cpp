#include "io/images/mask_image.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <string>

#include "io/images/mask_runs.hpp"

namespace motorcade {
namespace {

void paint(const ObjectMask& mask, std::uint16_t value, Gray16Image& image) {
  forEachRun(mask, image.width, image.height, [&](const MaskRun& run) {
    for (int v = run.v_begin; v < run.v_end; ++v)
      std::fill_n(image.pixels.begin() + std::ptrdiff_t{v} * image.width + run.u_begin, run.u_end - run.u_begin, value);
  });
}

}  // namespace

Gray16Image maskImage(const FrameEstimate& frame, const std::vector<ObjectMask>& masks, int width_px, int height_px) {
  Gray16Image image;
  image.width = width_px;
  image.height = height_px;
  image.pixels.assign(static_cast<std::size_t>(width_px) * height_px, 0);
  const SE3 T_cam_world = frame.T_world_cam.inverse();
  const auto distance_m = [&](const ObjectMask* mask) {
    const auto object = std::ranges::find(frame.objects, mask->track, &ObjectEstimate::track);
    return object == frame.objects.end() ? std::numeric_limits<double>::max()
                                         : (T_cam_world * object->T_world_body.translation()).z();
  };
  std::vector<const ObjectMask*> farthest_first;
  for (const ObjectMask& mask : masks) farthest_first.push_back(&mask);
  std::ranges::stable_sort(farthest_first, std::ranges::greater{}, distance_m);
  for (const ObjectMask* mask : farthest_first) paint(*mask, maskValue(mask->track), image);
  return image;
}

std::uint16_t maskValue(TrackId track) {
  return static_cast<std::uint16_t>(track.value % std::numeric_limits<std::uint16_t>::max() + 1);
}

TrackId trackOfMask(std::uint16_t value) { return {value - 1}; }

std::filesystem::path maskFile(const std::filesystem::path& folder, FrameId frame) {
  std::array<char, 32> name;
  std::snprintf(name.data(), name.size(), "%06lld.png", static_cast<long long>(frame.value));
  return folder / name.data();
}

bool isMaskFile(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  return file.extension() == ".png" && stem.size() >= 6 && stem.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace motorcade
