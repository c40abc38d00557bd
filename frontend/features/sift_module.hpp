#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Interface of the module `sift.so` (core/module.hpp): OpenCV's SIFT. The number in the function's name counts up with
/// every change in this file, so that a module of another version is refused.
namespace motorcade {

struct SiftImage {
  const std::uint8_t* pixels;
  int width_px, height_px;
  std::ptrdiff_t stride_bytes;
};

struct SiftKeypoint {
  float u_px, v_px, response;
  std::array<float, 128> descriptor;
};

inline constexpr char kSiftModule[] = "sift", kSiftFunction[] = "motorcade_sift_1";

/// Appends the points that SIFT finds in an image, each once. Where it fails, `problem` says why.
extern "C" void motorcade_sift_1(const SiftImage& image, int max_points, std::vector<SiftKeypoint>& keypoints,
                                 std::string& problem) noexcept;

}  // namespace motorcade
