#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/geometry/point_grid.hpp"
#include "frontend/messages.hpp"

/// Guesses of where a point of the previous image may have gone, from which its alignment can start.
namespace motorcade {

/// Minimum and maximum by value: the standard library's, which take references, become branches.
inline std::int64_t lesser(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
inline std::int64_t greater(std::int64_t a, std::int64_t b) { return a < b ? b : a; }

struct Shift {
  float du_px = 0, dv_px = 0;
};

/// Inclusive bounds on a shift.
struct ShiftBounds {
  float min_du_px, max_du_px, min_dv_px, max_dv_px;
  bool contain(float du_px, float dv_px) const {
    return du_px >= min_du_px && du_px <= max_du_px && dv_px >= min_dv_px && dv_px <= max_dv_px;
  }
};

/// Shifts worth trying for one point: at most those of its neighbors and of two similar corners.
struct Guesses {
  std::array<Shift, 3> shifts;
  std::size_t count = 0;
  void add(const Shift& shift) { shifts[count++] = shift; }
  std::span<const Shift> all() const { return {shifts.data(), count}; }
};

/// Appearance of a point for a quick comparison: 8x8 pixels of each of the two finest levels, their means moved to 128.
class alignas(64) Signature {
 public:
  static constexpr int kSide = 8, kPixels = 2 * kSide * kSide;
  Signature(const ImagePyramid& pyramid, float u_px, float v_px);
  /// Sum of the absolute differences of the pixels.
  int distance(const Signature& other) const;

  const std::uint8_t* pixels() const { return values_.data(); }

 private:
  std::array<std::uint8_t, kPixels> values_;
};

/// Looks up corners of an image where a point of the previous image may have gone. It refers to the features.
class CornerLookup {
 public:
  explicit CornerLookup(const Features& features);
  /// Adds shifts from a point of the previous image to the two most similar corners within the bounds. They must differ
  /// from it by less than `max_difference` gray levels per pixel.
  void addSimilar(const Signature& look, const Eigen::Vector2f& point_px, const ShiftBounds& bounds,
                  double max_difference, Guesses& guesses) const;

 private:
  const std::vector<Corner>& corners_;
  PointGrid grid_;
  // Of each corner, as the grid has them, with a vector of others behind.
  std::vector<float> us_px_, vs_px_;
  std::vector<Signature> signatures_;
};

}  // namespace motorcade
