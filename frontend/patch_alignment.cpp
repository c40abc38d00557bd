#include "frontend/patch_alignment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <cstring>
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <Eigen/LU>

#include "frontend/image_pyramid.hpp"
#include "frontend/window_differences.hpp"

namespace motorcade {
namespace {

constexpr int kStride = PatchTemplate::kStride;
constexpr int kMaxShearShift_px = 4;  // of a patch's first and last row against its middle
constexpr int kBlockRows = kMaxPatchWindow_px + 3;
constexpr int kBlockStride = 48;
static_assert(kMaxPatchWindow_px + 2 * kMaxShearShift_px + 4 + kStride + 1 <= kBlockStride);

// Vectors of the compilers' own kind; GCC 12 turns their widening of bytes into scalar code, hence the intrinsics.
using Lanes = float __attribute__((vector_size(32)));

#ifdef __AVX2__
inline Lanes pixels(const std::uint8_t* p) {
  return Lanes(_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)))));
}
/// p[columns[i]] for columns below 16.
inline Lanes pixelsAt(const std::uint8_t* p, const std::uint8_t* columns) {
  const __m128i row = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  const __m128i picked = _mm_shuffle_epi8(row, _mm_loadl_epi64(reinterpret_cast<const __m128i*>(columns)));
  return Lanes(_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(picked)));
}
#else
inline Lanes pixels(const std::uint8_t* p) {
  Lanes lanes;
  for (int i = 0; i < 8; ++i) lanes[i] = p[i];
  return lanes;
}
inline Lanes pixelsAt(const std::uint8_t* p, const std::uint8_t* columns) {
  Lanes lanes;
  for (int i = 0; i < 8; ++i) lanes[i] = p[columns[i]];
  return lanes;
}
#endif

inline Lanes floats(const float* p) {
  Lanes lanes;
  std::memcpy(&lanes, p, sizeof lanes);
  return lanes;
}

inline float total(const Lanes& x) { return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7])); }

/// A rectangle of pixels with room to read beyond its right edge: in the image itself, or copied with the border repeated.
class Block {
 public:
  Block(const Image& image, int x, int y, int columns, int rows) {
    if (x >= 0 && y >= 0 && x + columns <= image.width() && y + rows <= image.height()) {
      origin_ = image.row(y) + x;
      stride_ = image.stride();
      return;
    }
    assert(rows <= kBlockRows && columns <= kBlockStride);
    for (int r = 0; r < rows; ++r) {
      const std::uint8_t* row = image.row(std::clamp(y + r, 0, image.height() - 1));
      for (int c = 0; c < kBlockStride; ++c) copy_[r * kBlockStride + c] = row[std::clamp(x + c, 0, image.width() - 1)];
    }
    origin_ = copy_.data();
    stride_ = kBlockStride;
  }
  const std::uint8_t* row(int r) const { return origin_ + r * stride_; }

 private:
  const std::uint8_t* origin_;
  std::ptrdiff_t stride_;
  std::array<std::uint8_t, kBlockRows * kBlockStride + 32> copy_;  // not filled unless needed
};

bool inside(const Image& image, float u_px, float v_px) {
  return u_px >= 0 && v_px >= 0 && u_px <= static_cast<float>(image.width() - 1) && v_px <= static_cast<float>(image.height() - 1);
}

/// Bilinear samples of a square around (u, v), `kStride` apart; what follows the last column is unspecified but finite.
void sampleSquare(const Image& image, float u_px, float v_px, int side_px, float* out) {
  const int half = side_px / 2;
  const float left = u_px - static_cast<float>(half), top = v_px - static_cast<float>(half);
  const int x = static_cast<int>(std::floor(left)), y = static_cast<int>(std::floor(top));
  const float fx = left - static_cast<float>(x), fy = top - static_cast<float>(y);
  const Block block(image, x, y, side_px + 1, side_px + 1);
  for (int r = 0; r < side_px; ++r) {
    const std::uint8_t *p = block.row(r), *q = block.row(r + 1);
    for (int c = 0; c < kStride; c += 8) {
      const Lanes upper = pixels(p + c) * (1 - fx) + pixels(p + c + 1) * fx;
      const Lanes lower = pixels(q + c) * (1 - fx) + pixels(q + c + 1) * fx;
      const Lanes value = upper * (1 - fy) + lower * fy;
      std::memcpy(out + r * kStride + c, &value, sizeof value);
    }
  }
}

/// Where eight neighbouring samples of a row lie that are not a pixel apart.
struct SampleColumns {
  int first = 0;                                           // pixel
  alignas(8) std::array<std::uint8_t, 8> left{}, right{};  // pixels beside each sample, from the first on
  Lanes weight{};                                          // of the right one
};

/// The same with samples 1 / scale px apart; the scale is at least `kMinTemplateScale`.
void sampleScaledSquare(const Image& image, float u_px, float v_px, int side_px, float scale, float* out) {
  const int half = side_px / 2;
  const auto last_u = static_cast<float>(image.width() - 1), last_v = static_cast<float>(image.height() - 1);
  std::array<SampleColumns, kStride / 8> columns;
  for (int c = 0; c < kStride; ++c) {
    SampleColumns& group = columns[static_cast<std::size_t>(c / 8)];
    const auto lane = static_cast<std::size_t>(c % 8);
    const float u = std::clamp(u_px + static_cast<float>(c - half) / scale, 0.0F, last_u);
    const int x = std::min(static_cast<int>(u), image.width() - 2);
    if (lane == 0) group.first = x;
    group.left[lane] = static_cast<std::uint8_t>(x - group.first);
    group.right[lane] = static_cast<std::uint8_t>(x + 1 - group.first);
    group.weight[c % 8] = u - static_cast<float>(x);
  }
  for (int r = 0; r < side_px; ++r) {
    const float v = std::clamp(v_px + static_cast<float>(r - half) / scale, 0.0F, last_v);
    const int y = std::min(static_cast<int>(v), image.height() - 2);
    const float fy = v - static_cast<float>(y);
    for (int c = 0; c < kStride; c += 8) {
      const SampleColumns& group = columns[static_cast<std::size_t>(c / 8)];
      const std::uint8_t *p = image.row(y) + group.first, *q = image.row(y + 1) + group.first;
      const Lanes p_left = pixelsAt(p, group.left.data()), q_left = pixelsAt(q, group.left.data());
      const Lanes upper = p_left + group.weight * (pixelsAt(p, group.right.data()) - p_left);
      const Lanes lower = q_left + group.weight * (pixelsAt(q, group.right.data()) - q_left);
      const Lanes value = upper + fy * (lower - upper);
      std::memcpy(out + r * kStride + c, &value, sizeof value);
    }
  }
}

/// What alignment needs to know of the other image's patch J.
struct Moments {
  float appearance = 0;     // sum(a J)
  Eigen::Vector3f descent;  // sum(D J)
  float variation = 0;      // sum((J - mean)^2)
};

struct MomentLanes {
  Lanes appearance{}, d0{}, d1{}, d2{}, sum{}, squares{};

  void add(const PatchTemplate& patch, int offset, const Lanes& inside_window, const Lanes& j) {
    appearance += floats(patch.appearance.data() + offset) * j;
    d0 += floats(patch.descent[0].data() + offset) * j;
    d1 += floats(patch.descent[1].data() + offset) * j;
    d2 += floats(patch.descent[2].data() + offset) * j;
    const Lanes inner = j * inside_window;
    sum += inner;
    squares += inner * j;
  }

  Moments moments(int pixels_in_window) const {
    const float s = total(sum);
    return {total(appearance), {total(d0), total(d1), total(d2)}, total(squares) - s * s / static_cast<float>(pixels_in_window)};
  }
};

std::array<Lanes, 2> windowMask(int window_px) {
  std::array<Lanes, 2> mask{};
  for (int c = 0; c < window_px; ++c) mask[static_cast<std::size_t>(c / 8)][c % 8] = 1;
  return mask;
}

/// Moments of the patch at (u, v). Intensities are taken relative to the template's mean, which changes no moment but keeps digits.
Moments momentsAt(const PatchTemplate& patch, const Image& image, float u_px, float v_px) {
  const int window = patch.window_px, half = window / 2;
  const float top = v_px - static_cast<float>(half), left = u_px - static_cast<float>(half);
  const int y = static_cast<int>(std::floor(top)), x = static_cast<int>(std::floor(left));
  const Block block(image, x, y, window + 1, window + 1);
  const float fx = left - static_cast<float>(x), fy = top - static_cast<float>(y);
  const auto mask = windowMask(window);
  const auto between = [&](const std::uint8_t* p) {
    const Lanes here = pixels(p);
    return here + fx * (pixels(p + 1) - here);
  };
  std::array<Lanes, 2> upper{between(block.row(0)) - patch.mean, between(block.row(0) + 8) - patch.mean};
  MomentLanes lanes;
  for (int r = 0; r < window; ++r) {
    for (int c = 0; c < kStride; c += 8) {
      const auto group = static_cast<std::size_t>(c / 8);
      const Lanes lower = between(block.row(r + 1) + c) - patch.mean;
      lanes.add(patch, r * kStride + c, mask[group], upper[group] + fy * (lower - upper[group]));
      upper[group] = lower;
    }
  }
  return lanes.moments(window * window);
}

/// The same with the rows shifted by `shear` px per row.
Moments momentsAt(const PatchTemplate& patch, const Image& image, float u_px, float v_px, float shear) {
  const int window = patch.window_px, half = window / 2;
  const float top = v_px - static_cast<float>(half), left = u_px - static_cast<float>(half);
  const float reach = std::abs(shear) * static_cast<float>(half);
  const int y = static_cast<int>(std::floor(top)), x = static_cast<int>(std::floor(left - reach));
  const int end = static_cast<int>(std::floor(left + reach)) + window + 1;
  const Block block(image, x, y, end - x, window + 1);
  const float fy = top - static_cast<float>(y);
  const auto mask = windowMask(window);
  MomentLanes lanes;
  for (int r = 0; r < window; ++r) {
    const float row_left = left + shear * static_cast<float>(r - half) - static_cast<float>(x);
    const int column = static_cast<int>(row_left);
    const float fx = row_left - static_cast<float>(column);
    const float w00 = (1 - fx) * (1 - fy), w01 = fx * (1 - fy), w10 = (1 - fx) * fy, w11 = fx * fy;
    const std::uint8_t *p = block.row(r) + column, *q = block.row(r + 1) + column;
    for (int c = 0; c < kStride; c += 8) {
      const Lanes j = pixels(p + c) * w00 + pixels(p + c + 1) * w01 + pixels(q + c) * w10 + pixels(q + c + 1) * w11 - patch.mean;
      lanes.add(patch, r * kStride + c, mask[static_cast<std::size_t>(c / 8)], j);
    }
  }
  return lanes.moments(window * window);
}

using Square = std::array<float, kStride*(kMaxPatchWindow_px + 3)>;  // lanes beyond the window read into one row more

void store(PatchTemplate::Plane& plane, int offset, const Lanes& lanes) { std::memcpy(plane.data() + offset, &lanes, sizeof lanes); }

/// Calls f(offset in a plane, the same pixel in a square with a border of one, mask, row and column from the middle) for eight pixels at a
/// time.
template <class Function>
void forEachLanes(int window_px, const Function& f) {
  const auto mask = windowMask(window_px);
  const Lanes ramp{0, 1, 2, 3, 4, 5, 6, 7};
  const int half = window_px / 2;
  for (int r = 0; r < window_px; ++r)
    for (int c = 0; c < kStride; c += 8)
      f(r * kStride + c, (r + 1) * kStride + c + 1, mask[static_cast<std::size_t>(c / 8)], static_cast<float>(r - half),
        ramp + static_cast<float>(c - half));
}

/// Fills appearance, mean and norm.
void setAppearance(PatchTemplate& patch, const Square& square) {
  Lanes sums{}, squares{};
  forEachLanes(patch.window_px, [&](int, int s, const Lanes& mask, float, const Lanes&) { sums += floats(square.data() + s) * mask; });
  patch.mean = total(sums) / static_cast<float>(patch.window_px * patch.window_px);
  forEachLanes(patch.window_px, [&](int i, int s, const Lanes& mask, float, const Lanes&) {
    const Lanes value = (floats(square.data() + s) - patch.mean) * mask;
    squares += value * value;
    store(patch.appearance, i, value);
  });
  patch.norm = std::sqrt(total(squares));
  const float scale = patch.norm > 0 ? 1 / patch.norm : 0;
  for (int i = 0; i < patch.window_px * kStride; i += 8) store(patch.appearance, i, floats(patch.appearance.data() + i) * scale);
}

/// Fills the derivatives by the parameters.
void setDescent(PatchTemplate& patch, const Square& square, PatchDeformation deformation) {
  const bool scale = deformation == PatchDeformation::kScale;
  forEachLanes(patch.window_px, [&](int i, int offset, const Lanes& mask, float y, const Lanes& x) {
    const float* s = square.data() + offset;
    const Lanes du = (floats(s + 1) - floats(s - 1)) * (0.5F * mask);
    const Lanes dv = (floats(s + kStride) - floats(s - kStride)) * (0.5F * mask);
    store(patch.descent[0], i, du);
    store(patch.descent[1], i, scale ? dv : du * y);
    store(patch.descent[2], i, scale ? du * x + dv * y : du * x);
  });
}

/// Takes the mean and the component along the appearance out of a derivative: a change of bias or gain is no motion.
void orthogonalize(const PatchTemplate& patch, PatchTemplate::Plane& plane) {
  Lanes sums{}, alongs{};
  for (int i = 0; i < patch.window_px * kStride; i += 8) {
    const Lanes d = floats(plane.data() + i);
    sums += d;
    alongs += d * floats(patch.appearance.data() + i);
  }
  const float mean = total(sums) / static_cast<float>(patch.window_px * patch.window_px), along = total(alongs);
  forEachLanes(patch.window_px, [&](int i, int, const Lanes& mask, float, const Lanes&) {
    store(plane, i, floats(plane.data() + i) - mask * mean - along * floats(patch.appearance.data() + i));
  });
}

Eigen::Matrix3f gram(const PatchTemplate& patch) {
  Eigen::Matrix3f result;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      Lanes lanes{};
      for (int i = 0; i < patch.window_px * kStride; i += 8)
        lanes += floats(patch.descent[a].data() + i) * floats(patch.descent[b].data() + i);
      result(static_cast<int>(a), static_cast<int>(b)) = result(static_cast<int>(b), static_cast<int>(a)) = total(lanes);
    }
  }
  return result;
}

/// Information of a deformation whose standard deviation is `sigma`, for the noise that 8-bit images have at least (3 gray levels).
constexpr float priorInformation(float sigma) { return 9 / (sigma * sigma); }
constexpr float kScaleSigma = 0.1F, kRowSlopeSigma = 0.3F, kColumnSlopeSigma = 0.15F;
constexpr float kMaxStep_px = 1.5F;    // the gain comes out too small, and the step too long, while the patches do not overlap well
constexpr float kMinInformation = 60;  // of the shift: root mean square gradient of 0.7 gray levels per pixel over 11x11

/// Share of the patch that template and deformation explain, as a correlation.
float explainedCorrelation(const PatchTemplate& patch, const Moments& moments) {
  if (moments.appearance <= 0 || moments.variation <= 0) return 0;
  const float deformation = moments.descent.dot(patch.inverse_hessian * moments.descent);
  return std::sqrt(std::min(1.0F, (moments.appearance * moments.appearance + deformation) / moments.variation));
}

/// Standard deviation of the shift along parameter i, from a residual taken as white. What that leaves out (noise in the gradients of H,
/// deformations beyond the model) is in the factor, fitted to the median error on rendered street scenes.
constexpr float kSigmaFactor = 1.35F;
float shiftSigma(const PatchTemplate& patch, const Moments& moments, float ncc, int parameter) {
  const float gain = moments.appearance / patch.norm;
  const int freedom = patch.window_px * patch.window_px - 5;
  const float noise_variance = std::max(0.0F, moments.variation * (1 - ncc * ncc)) / static_cast<float>(freedom);
  return kSigmaFactor * std::sqrt(noise_variance * patch.inverse_hessian(parameter, parameter)) / gain;
}

}  // namespace

std::optional<PatchTemplate> makeTemplate(const Image& image, float u_px, float v_px, int window_px, PatchDeformation deformation,
                                          float scale) {
  assert(window_px % 2 == 1 && window_px <= kMaxPatchWindow_px);
  std::optional<PatchTemplate> patch;  // the only object returned, so that it is never copied
  if (!inside(image, u_px, v_px) || scale < kMinTemplateScale) return patch;
  alignas(32) Square square;
  if (scale == 1) {
    sampleSquare(image, u_px, v_px, window_px + 2, square.data());
  } else {
    sampleScaledSquare(image, u_px, v_px, window_px + 2, scale, square.data());
  }
  std::fill_n(square.begin() + (window_px + 2) * kStride, kStride, 0.0F);
  patch.emplace();
  patch->window_px = window_px;
  setAppearance(*patch, square);
  setDescent(*patch, square, deformation);
  for (auto& plane : patch->descent) orthogonalize(*patch, plane);

  Eigen::Matrix3f hessian = gram(*patch);
  bool textured = false;
  if (deformation == PatchDeformation::kScale) {
    patch->prior = {0, 0, priorInformation(kScaleSigma)};
    const Eigen::Matrix2f shift = hessian.topLeftCorner<2, 2>();
    textured = shift.determinant() > kMinInformation * shift.trace();
  } else {
    patch->prior = {0, priorInformation(kRowSlopeSigma), priorInformation(kColumnSlopeSigma)};
    textured = hessian(0, 0) > kMinInformation;
  }
  hessian.diagonal() += patch->prior;
  patch->inverse_hessian = hessian.inverse();
  if (!textured) patch.reset();
  return patch;
}

std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, float u_guess_px, float v_guess_px,
                                       const PatchParams& params) {
  float u = u_guess_px, v = v_guess_px;
  for (int iteration = 0; iteration < params.max_iterations; ++iteration) {
    if (!inside(image, u, v)) return std::nullopt;
    const Moments moments = momentsAt(patch, image, u, v);
    if (moments.appearance <= 0) return std::nullopt;
    Eigen::Vector3f step = patch.inverse_hessian * moments.descent * (patch.norm / moments.appearance);
    step *= std::min(1.0F, kMaxStep_px / step.head<2>().norm());
    u -= step.x();
    v -= step.y();
    if (std::hypot(u - u_guess_px, v - v_guess_px) > params.max_shift_px) return std::nullopt;
    if (step.head<2>().squaredNorm() > params.max_step_px * params.max_step_px) continue;
    const float ncc = explainedCorrelation(patch, moments);
    if (ncc < params.min_ncc) return std::nullopt;
    const float sigma = std::max(shiftSigma(patch, moments, ncc, 0), shiftSigma(patch, moments, ncc, 1));
    return AlignedPatch{u, v, ncc, -step[2], std::hypot(sigma, static_cast<float>(params.sigma_floor_px))};
  }
  return std::nullopt;
}

std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, float u_px, float v_px, const ImagePyramid& to, float u_guess_px,
                                       float v_guess_px, int first_level, const PatchParams& params) {
  float u = u_guess_px, v = v_guess_px;
  std::optional<AlignedPatch> aligned;
  for (int level = first_level; level >= 0; --level) {
    const auto i = static_cast<std::size_t>(level);
    const auto patch = makeTemplate(from.levels[i], toLevel(u_px, level), toLevel(v_px, level), params.window_px, PatchDeformation::kScale);
    if (patch) aligned = alignPatch(*patch, to.levels[i], toLevel(u, level), toLevel(v, level), params);
    if (!patch || !aligned) {
      if (level == 0) return std::nullopt;
      continue;  // a coarse level without texture only gives no better guess
    }
    u = fromLevel(aligned->u_px, level);
    v = fromLevel(aligned->v_px, level);
  }
  return aligned;
}

float correlation(const PatchTemplate& patch, const Image& image, float u_px, float v_px) {
  if (!inside(image, u_px, v_px)) return -1;
  const Moments moments = momentsAt(patch, image, u_px, v_px);
  return moments.variation > 0 ? moments.appearance / std::sqrt(moments.variation) : -1;
}

namespace {

/// Whole-pixel disparity with the smallest difference within the radius of the prediction; the prediction when no window fits.
double searchAround(const Image& left, const Image& right, double u_px, double v_px, double predicted_px, double radius_px) {
  constexpr WindowSize kWindow;
  const int u = static_cast<int>(std::lround(u_px)), v = static_cast<int>(std::lround(v_px)), half = kWindow.columns / 2;
  const int radius = static_cast<int>(std::ceil(radius_px));
  const int middle = static_cast<int>(std::lround(u_px - predicted_px));
  const int first = std::max(middle - radius, half), last = std::min(middle + radius, right.width() - 1 - half);
  const bool rows_fit = v >= kWindow.rows / 2 && v + kWindow.rows / 2 < left.height();
  if (last <= first || !rows_fit || u < half || u + half >= left.width()) return predicted_px;
  std::array<std::uint16_t, kMaxWindowCosts> costs;
  const auto count = static_cast<std::size_t>(std::min(last - first + 1, kMaxWindowCosts));
  windowDifferences(left, u, v, right, first, v, kWindow, std::span(costs).first(count));
  const auto best = std::min_element(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(count)) - costs.begin();
  return u - (first + static_cast<double>(best));
}

}  // namespace

std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px, double predicted_disparity_px,
                                           const DisparityParams& params) {
  const auto u = static_cast<float>(u_px), v = static_cast<float>(v_px);
  const auto patch = makeTemplate(left, u, v, params.window_px, PatchDeformation::kSlope);
  if (!patch) return std::nullopt;
  double start_px = predicted_disparity_px;
  if (params.search_radius_px > 0) start_px = searchAround(left, right, u_px, v_px, predicted_disparity_px, params.search_radius_px);

  constexpr float kConverged_px = 0.02F, kMaxShift_px = 2;
  const int half = params.window_px / 2;
  const float max_slope = static_cast<float>(kMaxShearShift_px) / static_cast<float>(half);
  float u_right = u - static_cast<float>(start_px), slope = 0;
  const float first_guess = u_right;
  for (int iteration = 0; iteration < params.max_iterations; ++iteration) {
    if (!inside(right, u_right, v)) return std::nullopt;
    Moments moments = momentsAt(*patch, right, u_right, v, slope);
    if (moments.appearance <= 0) return std::nullopt;
    const float gain = moments.appearance / patch->norm;
    const Eigen::Vector3f pull(0, gain * patch->prior[1] * slope, 0);
    Eigen::Vector3f step = patch->inverse_hessian * (moments.descent + pull) / gain;
    step[0] = std::clamp(step[0], -kMaxStep_px, kMaxStep_px);
    u_right -= step[0];
    slope = std::clamp(slope - step[1], -max_slope, max_slope);
    if (std::abs(u_right - first_guess) > kMaxShift_px) return std::nullopt;
    if (std::abs(step[0]) > kConverged_px && iteration + 1 < params.max_iterations) continue;

    const float ncc = explainedCorrelation(*patch, moments);
    const float sigma = std::hypot(shiftSigma(*patch, moments, ncc, 0), static_cast<float>(params.sigma_floor_px));
    if (ncc < params.min_ncc || sigma > params.max_sigma_px || u - u_right <= 0) return std::nullopt;
    return StereoMatch{u - u_right, sigma};
  }
  return std::nullopt;
}

}  // namespace motorcade
