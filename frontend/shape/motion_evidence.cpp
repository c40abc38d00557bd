#include "frontend/shape/motion_evidence.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace motorcade {
namespace {

constexpr float kLeastShift = 1.5F;  // cells between where the body's motion and rest take a point
constexpr int kLeastDifference = 5;  // gray levels by which rest explains the brightness better
constexpr int kAround = 2;           // cells on each side, that together tell whether one rests

bool has3x3(const Image& image, int u, int v) {
  return u >= 1 && v >= 1 && u + 1 < image.width() && v + 1 < image.height();
}

/// The 3x3 pixels around a place of an image, to be compared with others.
class Pixels3x3 {
 public:
#ifdef __SSE2__
  Pixels3x3(const Image& image, int u, int v) {
    const auto row = [&](int y) {
      std::uint32_t pixels = 0;  // and one that does not count: behind an image's last row, too, bytes may be read
      std::memcpy(&pixels, image.row(y) + u - 1, sizeof pixels);
      return pixels & 0xFFFFFFU;
    };
    pixels_ = _mm_set_epi64x(static_cast<std::int64_t>(row(v + 1)),
                             static_cast<std::int64_t>(row(v) | static_cast<std::uint64_t>(row(v - 1)) << 32));
  }
  int differenceFrom(const Pixels3x3& other) const {
    const __m128i sums = _mm_sad_epu8(pixels_, other.pixels_);
    return _mm_cvtsi128_si32(_mm_add_epi32(sums, _mm_unpackhi_epi64(sums, sums)));
  }

 private:
  __m128i pixels_;
#else
  Pixels3x3(const Image& image, int u, int v) {
    for (int y = 0; y < 3; ++y) std::copy_n(image.row(v + y - 1) + u - 1, 3, pixels_.data() + 3 * y);
  }
  int differenceFrom(const Pixels3x3& other) const {
    int sum = 0;
    for (std::size_t i = 0; i < pixels_.size(); ++i) sum += std::abs(pixels_[i] - other.pixels_[i]);
    return sum;
  }

 private:
  std::array<std::uint8_t, 9> pixels_;
#endif
};

/// Sums over the cells up to kAround away of values of a window, row after row.
class SumsAround {
 public:
  /// Zeros, to be set before the first row.
  explicit SumsAround(const PixelWindow& window)
      : values(window.area(), 0), window_(window), of_columns_(window.width + 2 * kAround, 0) {}

  void goTo(int row) {
    if (row == 0)
      for (int first = 0; first < kAround; ++first) addRow(first, 1);
    addRow(row + kAround, 1);
    addRow(row - kAround - 1, -1);
  }
  int at(int column) const {
    static_assert(kAround == 2);
    const std::int16_t* sums = of_columns_.data() + column;
    return sums[0] + sums[1] + sums[2] + sums[3] + sums[4];
  }
  /// In the row that was gone to.
  void clear(int column, int row) {
    std::int16_t& value = values[static_cast<std::size_t>(row) * window_.width + column];
    of_columns_[column + kAround] = static_cast<std::int16_t>(of_columns_[column + kAround] - value);
    value = 0;
  }

  std::vector<std::int16_t> values;

 private:
  void addRow(int row, int sign) {
    if (row < 0 || row >= window_.height) return;
    const std::int16_t* of_row = values.data() + static_cast<std::size_t>(row) * window_.width;
    std::int16_t* columns = of_columns_.data() + kAround;
    for (int u = 0; u < window_.width; ++u) columns[u] = static_cast<std::int16_t>(columns[u] + sign * of_row[u]);
  }

  PixelWindow window_;
  std::vector<std::int16_t> of_columns_;
};

}  // namespace

MotionEvidence::MotionEvidence(const LevelDisparities& disparities, const ObjectView& view,
                               const ObjectView::Before& before, const StereoCamera& camera, int slack)
    : map_(disparities.map),
      now_(before.now->levels[disparities.level]),
      before_(before.before->levels[disparities.level]),
      slack_(slack),
      scale_(static_cast<float>(1 << disparities.level)),
      offset_px_(static_cast<float>(view.disparity_offset_px)),
      fb_(static_cast<float>(camera.fx_px * camera.baseline_m)),
      focal_(Eigen::Vector2d(camera.fx_px, camera.fy_px).cast<float>() / scale_),
      middle_(toLevel(static_cast<float>(camera.cx_px), disparities.level),
              toLevel(static_cast<float>(camera.cy_px), disparities.level)) {
  const auto motion = [](const SE3& T_before_cam) {
    return Motion{T_before_cam.rotation().cast<float>(), T_before_cam.translation().cast<float>()};
  };
  moved_ = motion(before.T_before_body * view.T_cam_body.inverse());
  rested_ = motion(before.T_before_cam);
}

std::vector<std::int16_t> MotionEvidence::operator()(std::span<const int> cells) const {
  std::vector<std::int16_t> evidence(cells.size());
  for (std::size_t i = 0; i < cells.size(); i += kFloatLanes)
    compare(cells.subspan(i, std::min<std::size_t>(kFloatLanes, cells.size() - i)), evidence.data() + i);
  return evidence;
}

/// Up to kFloatLanes cells.
void MotionEvidence::compare(std::span<const int> cells, std::int16_t* evidence) const {
  Lanes columns{}, rows{}, disparities_px;
  disparities_px.fill(1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    columns[i] = static_cast<float>(map_.window.u0 + cells[i] % map_.window.width);
    rows[i] = static_cast<float>(map_.window.v0 + cells[i] / map_.window.width);
    disparities_px[i] = map_.disparity_px[cells[i]];
  }
  const Floats z = fb_ / (loadFloats(disparities_px.data()) * scale_ + offset_px_);
  const std::array<Floats, 3> p_cam{(loadFloats(columns.data()) - middle_.x()) * (1 / focal_.x()) * z,
                                    (loadFloats(rows.data()) - middle_.y()) * (1 / focal_.y()) * z, z};
  const Places moved = before(moved_, p_cam), rested = before(rested_, p_cam);
  constexpr auto kNear_m = static_cast<float>(StereoCamera::kMinDepth_m);
  const float least_shift = kLeastShift + static_cast<float>(2 * slack_);
  const Floats du = moved.u - rested.u, dv = moved.v - rested.v;
  const FloatMask tells =
      (moved.depth_m >= kNear_m) & (rested.depth_m >= kNear_m) & (du * du + dv * dv >= least_shift * least_shift);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int lane = static_cast<int>(i);
    evidence[i] = static_cast<std::int16_t>(tells[lane] != 0 ? difference(cells[i], moved, rested, lane) : 0);
  }
}

MotionEvidence::Places MotionEvidence::before(const Motion& motion, const std::array<Floats, 3>& p_cam) const {
  std::array<Floats, 3> p;
  for (int i = 0; i < 3; ++i)
    p[i] = motion.R(i, 0) * p_cam[0] + motion.R(i, 1) * p_cam[1] + motion.R(i, 2) * p_cam[2] + motion.t[i];
  return {focal_.x() * (p[0] / p[2]) + middle_.x(), focal_.y() * (p[1] / p[2]) + middle_.y(), p[2]};
}

/// Zero where one of the places is outside its image.
int MotionEvidence::difference(int cell, const Places& moved, const Places& rested, int lane) const {
  const auto nearest = [](float px) { return static_cast<int>(px + 0.5F); };  // what is negative is outside in any case
  const int u = map_.window.u0 + cell % map_.window.width, v = map_.window.v0 + cell / map_.window.width;
  const int u_moved = nearest(moved.u[lane]), v_moved = nearest(moved.v[lane]);
  const int u_rested = nearest(rested.u[lane]), v_rested = nearest(rested.v[lane]);
  if (!has3x3(now_, u, v) || !has3x3(before_, u_moved - slack_, v_moved - slack_) ||
      !has3x3(before_, u_moved + slack_, v_moved + slack_) || !has3x3(before_, u_rested - slack_, v_rested - slack_) ||
      !has3x3(before_, u_rested + slack_, v_rested + slack_))
    return 0;
  const Pixels3x3 now(now_, u, v);
  const auto least_around = [&](int u_before, int v_before) {
    int least = std::numeric_limits<int>::max();
    for (int j = -slack_; j <= slack_; ++j)
      for (int i = -slack_; i <= slack_; ++i)
        least = std::min(least, now.differenceFrom({before_, u_before + i, v_before + j}));
    return least;
  };
  return least_around(u_moved, v_moved) - least_around(u_rested, v_rested);
}

/// Every other cell tells, as on a chessboard; one that is dropped no longer does, but what it told stands.
void dropResting(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                 const StereoCamera& camera) {
  const int width = outline.window.width, height = outline.window.height;
  std::vector<int> telling;
  telling.reserve(outline.inside.size() / 2 + 1);
  for (int row = 0; row < height; ++row)
    for (int column = row % 2; column < width; column += 2)
      if (outline.at(column, row)) telling.push_back(row * width + column);
  const std::vector<std::int16_t> rests_rather = MotionEvidence(disparities, view, *view.before, camera)(telling);
  if (std::ranges::none_of(rests_rather, [](std::int16_t rests) { return rests > 0; })) return;
  SumsAround evidence(outline.window), tells(outline.window);
  for (std::size_t i = 0; i < telling.size(); ++i)
    evidence.values[telling[i]] = rests_rather[i], tells.values[telling[i]] = 1;
  constexpr int kLeast = kLeastDifference * MotionEvidence::kPixels;
  for (int row = 0; row < height; ++row) {
    evidence.goTo(row), tells.goTo(row);
    for (int column = 0; column < width; ++column) {
      if (!outline.at(column, row) || evidence.at(column) <= kLeast * tells.at(column)) continue;
      outline.inside[static_cast<std::size_t>(row) * width + column] = 0;
      tells.clear(column, row);
    }
  }
}

}  // namespace motorcade
