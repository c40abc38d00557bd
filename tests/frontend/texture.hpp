#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "frontend/messages.hpp"

namespace motorcade::test {

/// A smooth random pattern, a sum of plane waves no shorter than `min_wavelength_px`: it can be sampled anywhere, so
/// any shift is exact.
class Texture {
 public:
  explicit Texture(unsigned seed, double min_wavelength_px = 6, double max_wavelength_px = 40) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    for (Wave& wave : waves_) {
      const double frequency =
          2 * std::numbers::pi /
          (min_wavelength_px + (max_wavelength_px - min_wavelength_px) * unit(random) * unit(random));
      const double direction_rad = 2 * std::numbers::pi * unit(random);
      wave = {frequency * std::cos(direction_rad), frequency * std::sin(direction_rad),
              2 * std::numbers::pi * unit(random)};
    }
  }
  /// Gray level, around 128 with a standard deviation of 24.
  double operator()(double x, double y) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.fx * x + wave.fy * y + wave.phase);
    return 128 + 24 * sum * std::sqrt(2.0 / kWaves);
  }

 private:
  static constexpr int kWaves = 48;
  struct Wave {
    double fx, fy, phase;
  };
  std::array<Wave, kWaves> waves_;
};

struct Exposure {
  double gain = 1, bias = 0, noise = 0;
  unsigned seed = 1;
};

/// An image of gray(x, y) as a camera with this exposure sees it.
inline Image render(int width, int height, const std::function<double(double, double)>& gray,
                    const Exposure& exposure = {}) {
  std::mt19937_64 random(exposure.seed);
  std::normal_distribution<double> noise(0, 1);
  ImagePool pool;
  Image image = pool.acquire(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = exposure.gain * (gray(x, y) - 128) + 128 + exposure.bias + exposure.noise * noise(random);
      image.mutableRow(y)[x] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return image;
}

inline StereoFramePtr stereoFrame(int number, const Image& left, const Image& right) {
  auto frame = std::make_shared<StereoFrame>();
  frame->head.frame = {number};
  frame->left = left;
  frame->right = right;
  return frame;
}

inline StereoFramePtr rejectedFrame(int number) {
  auto frame = std::make_shared<StereoFrame>();
  frame->head.frame = {number};
  frame->reject(FrameCause::kUnusable, "no image");
  return frame;
}

}  // namespace motorcade::test
