#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/image.hpp"
#include "core/stereo_camera.hpp"
#include "io/rig/lens_camera.hpp"

namespace motorcade {

/// Rectifies the images of one camera, pixel by pixel, by bilinear interpolation. A pixel whose source lies outside the
/// raw image takes the nearest pixel of its edge. Built once per camera; applying it changes nothing in it, from any
/// thread.
class Remap {
 public:
  /// `R` takes directions of the raw camera to those of the rectified one, `target`.
  Remap(const LensCamera& raw, const Eigen::Matrix3d& R, const StereoCamera& target, ImageSize raw_size);

  /// Takes an image of the raw size and returns one of the rectified size.
  Image operator()(const Image& raw, ImagePool& pool) const;

  /// Share of the rectified pixels whose source lies outside the raw image.
  double shareOutside() const;

  /// Source position of a rectified pixel in the raw image, to the stored precision.
  Eigen::Vector2d source_px(int u, int v) const;

  /// Bits of the fraction of positions, which are multiples of 1/64 px. Products of two weights and a pixel stay exact
  /// in 32 bits. The error of at most 1/128 px is a tenth of a match's uncertainty.
  static constexpr int kFractionBits = 6;

  /// Source positions: the upper left of the four pixels that are weighed, and how far right and down of it, in 64ths.
  struct Sources {
    const std::int16_t *x, *y;
    const std::uint8_t *right, *down;
  };

 private:
  void fillRow(int v, const LensModel& lens, const Eigen::Matrix3d& R, const StereoCamera& target);

  ImageSize raw_size_, size_;
  std::size_t outside_ = 0;
  std::vector<std::int16_t> x_, y_;
  std::vector<std::uint8_t> right_, down_;
};

}  // namespace motorcade
