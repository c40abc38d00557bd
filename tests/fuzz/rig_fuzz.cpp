#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "io/rig/remap.hpp"
#include "io/rig/rig_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// The calibration of a pair that is not rectified, its rectification, a map by it, and an image by that.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  constexpr std::array<std::string_view, 8> kNoLine{"is missing",
                                                    "holds no keys",
                                                    "is no calibration of a pair",
                                                    "is no calibration that is read",
                                                    "camera",
                                                    "images",
                                                    "too large",
                                                    "the baseline"};
  constexpr ImageSize kSize{48, 32};
  const auto& path = file.holding(fuzz::textOf(data, size));
  for (const std::size_t files : {1U, 2U}) {
    fuzz::readOrRefuse(path.native(), kNoLine, [&] {
      const Rectification pair = rectificationOf(readRig(std::vector(files, path)), kSize);
      fuzz::require(std::isfinite(pair.camera.fx_px) && std::isfinite(pair.camera.cx_px), "a camera not finite");
      fuzz::require(pair.camera.baseline_m > 0, "no baseline");
      const Remap remap(pair.left, pair.R_left, pair.camera, kSize);
      for (int v = 0; v < kSize.height; ++v)
        for (int u = 0; u < kSize.width; ++u) {
          const Eigen::Vector2d source_px = remap.source_px(u, v);
          fuzz::require(source_px.x() >= 0 && source_px.x() <= kSize.width - 1, "a column outside");
          fuzz::require(source_px.y() >= 0 && source_px.y() <= kSize.height - 1, "a row outside");
        }
      ImagePool pool;
      Image raw = pool.acquire(kSize.width, kSize.height);
      for (int v = 0; v < kSize.height; ++v) std::fill_n(raw.mutableRow(v), kSize.width, std::uint8_t{9});
      fuzz::require(remap(raw, pool).at(kSize.width - 1, kSize.height - 1) == 9, "a pixel that is not in the image");
    });
  }
  return 0;
}
