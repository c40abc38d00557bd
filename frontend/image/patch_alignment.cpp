#include "frontend/image/patch_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/elementary.hpp"
#include "core/instruction_set.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/window_differences.hpp"

#define HWY_TARGET_INCLUDE "frontend/image/patch_alignment.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/patch_sampling.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kOtherShift = 3;        // from samples to words of the other image
constexpr int kMaxShearShift_px = 4;  // of a patch's first and last row against its middle
static_assert(kMaxPatchWindow_px + 2 * kMaxShearShift_px + 2 + 24 <= kBlockStride);

/// The sums over the other image's patch J that alignment needs.
struct Moments {
  FourFloats sums;              // sum(a J), sum(D J)
  std::int32_t total, squares;  // sum(J), sum(J J), in words

  float appearance() const { return sums[0]; }
  /// sum((J - mean)^2)
  float variation(int window_px) const {
    const std::int64_t pixels = window_px * window_px;
    return static_cast<float>(pixels * squares - std::int64_t{total} * total) *
           (PatchTemplate::kOtherUnit * PatchTemplate::kOtherUnit / static_cast<float>(pixels));
  }
};

/// Gathers the moments row by row; the other image's samples are taken relative to the template's mean.
class MomentSums {
 public:
  /// `mask` is that of the window, outside of which the samples are zero.
  MomentSums(const PatchTemplate& patch, const Words& mask)
      : patch_(patch), mean_(allWords(patch.mean - kHalfUnit) & mask) {}

  void add(int row, const Words& samples) {
    const Words j = (samples - mean_) >> kOtherShift;
    const auto plane = [&](const PatchTemplate::Plane& words)
                           HWY_ATTR { return load(words.data() + row * PatchTemplate::kStride); };
    appearance_ += products(plane(patch_.appearance), j);
    d0_ += products(plane(patch_.descent[0]), j);
    d1_ += products(plane(patch_.descent[1]), j);
    d2_ += products(plane(patch_.descent[2]), j);
    sum_ += j;
    squares_ += products(j, j);
  }

  Moments moments() const {
    const WordSums pairs = products(sum_, allWords(1));
    const FourSums others = totals(pairs, squares_, pairs, squares_);
    const FourFloats sums = __builtin_convertvector(totals(appearance_, d0_, d1_, d2_), FourFloats);
    const FourFloats total = allFour(static_cast<float>(others[0]) * PatchTemplate::kOtherUnit);
    const FourFloats corrected = patch_.units * sums - patch_.means * total;
    return {corrected - patch_.along * allFour(corrected[0]), others[0], others[1]};
  }

 private:
  const PatchTemplate& patch_;
  static constexpr int kHalfUnit = 1 << (kOtherShift - 1);  // so that words are rounded
  // Words of the other image are within 2048 of the mean, so that one holds the sum of a column.
  static_assert(kMaxPatchWindow_px * ((UINT8_MAX * kSampleLevels >> kOtherShift) + 1) <= INT16_MAX);
  Words mean_, sum_{};
  WordSums appearance_{}, d0_{}, d1_{}, d2_{}, squares_{};
};

/// Moments of the patch at (u, v).
[[gnu::always_inline]] inline Moments momentsAt(const PatchTemplate& patch, const Words& mask, const Image& image,
                                                const ColumnPosition& u, float v_px) {
  const int window = patch.window_px, half = window / 2;
  const RowPosition top(v_px - static_cast<float>(half));
  const Block block(image, u.pixel - half, top.pixel, window + 1, window + 1);
  const SampleColumns columns(allWords(SampleColumns::weightsOf(u.fraction)) & mask);
  const Words fraction = allWords(top.fraction);
  MomentSums sums(patch, mask);
  Words upper = columns(block.row(0));
  for (int r = 0; r < window; ++r) {
    const Words lower = columns(block.row(r + 1));
    sums.add(r, betweenRows(upper, lower, fraction));
    upper = lower;
  }
  return sums.moments();
}

/// Where the rows of a sheared patch begin in their block: pixels, and the weights of the columns.
struct RowStarts {
  RowStarts(float left_px, float shear, int half_px, int block_px) {
    for (int r = 0; r < kWordLanes; ++r) {
      const ColumnPosition start(left_px + shear * static_cast<float>(r - half_px) - static_cast<float>(block_px));
      pixels[r] = start.pixel;
      weights[r] = SampleColumns::weightsOf(start.fraction);
    }
  }
  std::array<int, kWordLanes> pixels;
  std::array<std::int16_t, kWordLanes> weights;
};

/// Moments of a patch whose rows are shifted by `shear` px per row.
Moments momentsAt(const PatchTemplate& patch, const Words& mask, const Image& image, const ColumnPosition& u,
                  float v_px, float shear) {
  const int window = patch.window_px, half = window / 2;
  const float left = u.px() - static_cast<float>(half), reach = std::abs(shear) * static_cast<float>(half);
  const RowPosition top(v_px - static_cast<float>(half));
  const int x = static_cast<int>(std::floor(left - reach)),
            end = static_cast<int>(std::floor(left + reach)) + window + 2;
  const Block block(image, x, top.pixel, end - x, window + 1);
  const RowStarts starts(left, shear, half, x);
  const Words fraction = allWords(top.fraction);
  MomentSums sums(patch, mask);
  for (int r = 0; r < window; ++r) {
    const SampleColumns columns(allWords(starts.weights[r]) & mask);
    const Words upper = columns(block.row(r) + starts.pixels[r]), lower = columns(block.row(r + 1) + starts.pixels[r]);
    sums.add(r, betweenRows(upper, lower, fraction));
  }
  return sums.moments();
}

/// Bound of a step: while the patches overlap poorly, the gain is underestimated and the step too long.
constexpr float kMaxStep_px = 1.5F;

/// Gauss-Newton iterations per level of an alignment in the image, and of a disparity, which has a whole-pixel start.
constexpr int kMaxIterations = 12, kMaxDisparityIterations = 8;

/// An alignment whose steps are still as long as this at its fourth, fifth, ... iteration (the last value holds for all
/// that follow) fails in the end, but for one in a hundred.
constexpr std::array kLost_px{1.0F, 0.7F, 0.45F, 0.3F, 0.2F};
constexpr int kFirstLost = 3;
bool isLost(int iteration, float step_px2) {
  if (iteration < kFirstLost) return false;
  constexpr int kLast = kLost_px.size() - 1;
  const float lost_px = kLost_px[std::min(iteration - kFirstLost, kLast)];
  return step_px2 > lost_px * lost_px;
}

/// The Gauss-Newton step, times the gain.
FourFloats solve(const PatchTemplate& patch, const FourFloats& descent) {
  const auto& [u, v, deformation] = patch.inverse_hessian;
  return u * allFour(descent[1]) + (v * allFour(descent[2]) + deformation * allFour(descent[3]));
}

/// Share of the patch's variation that template and deformation explain, as a correlation.
float explainedCorrelation(const PatchTemplate& patch, const Moments& moments, float variation) {
  if (moments.appearance() <= 0 || variation <= 0) return 0;
  const FourFloats explained = moments.sums * solve(patch, moments.sums);
  const float deformation = explained[1] + (explained[2] + explained[3]);
  return std::sqrt(std::min(1.0F, (moments.appearance() * moments.appearance() + deformation) / variation));
}

/// How well an alignment fits.
class Fit {
 public:
  Fit(const PatchTemplate& patch, const Moments& moments)
      : patch_(patch),
        variation_(moments.variation(patch.window_px)),
        gain_(moments.appearance() / patch.norm),
        ncc_(explainedCorrelation(patch, moments, variation_)) {}

  float ncc() const { return ncc_; }

  /// Standard deviation of the shift along a parameter, from a residual taken to be white. The factor accounts for
  /// noise in the gradients of H and for deformations beyond the model. It was fitted to the median error on rendered
  /// street scenes.
  float shiftSigma(int parameter) const {
    constexpr float kSigmaFactor = 1.35F;
    constexpr int kPatchParameters = 5;  // that the residual is free of: three of the deformation, gain and bias
    const int freedom = patch_.window_px * patch_.window_px - kPatchParameters;
    const float noise_variance = std::max(0.0F, variation_ * (1 - ncc_ * ncc_)) / static_cast<float>(freedom);
    return kSigmaFactor * std::sqrt(noise_variance * patch_.inverse_hessian[parameter][parameter + 1]) / gain_;
  }

 private:
  const PatchTemplate& patch_;
  float variation_, gain_, ncc_;
};

/// Squared length of a step's shift.
float squaredShift(const FourFloats& step) {
  const FourFloats squares = step * step;
  return squares[1] + squares[2];
}

}  // namespace

std::optional<AlignedPatch> align(const PatchTemplate& patch, const Image& image, const Eigen::Vector2f& guess_px,
                                  const PatchParams& params) {
  const auto max_shift_px2 = static_cast<float>(params.max_shift_px * params.max_shift_px);
  const double max_step_px2 = params.max_step_px * params.max_step_px;
  const Words mask = windowMask(patch.window_px);
  const float u_guess_px = guess_px.x(), v_guess_px = guess_px.y();
  float u = u_guess_px, v = v_guess_px;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!inside(image, u, v)) return std::nullopt;
    const ColumnPosition u_grid(u);
    const Moments moments = momentsAt(patch, mask, image, u_grid, v);
    if (moments.appearance() <= 0) return std::nullopt;
    FourFloats step = solve(patch, moments.sums) * allFour(patch.norm / moments.appearance());
    float step_px2 = squaredShift(step);
    if (step_px2 > kMaxStep_px * kMaxStep_px) {
      step *= allFour(kMaxStep_px / std::sqrt(step_px2));
      step_px2 = squaredShift(step);
    }
    u = u_grid.px() - step[1];
    v -= step[2];
    if ((u - u_guess_px) * (u - u_guess_px) + (v - v_guess_px) * (v - v_guess_px) > max_shift_px2) return std::nullopt;
    if (isLost(iteration, step_px2)) return std::nullopt;
    if (step_px2 > max_step_px2) continue;
    const Fit fit(patch, moments);
    if (fit.ncc() < params.min_ncc) return std::nullopt;
    const float sigma = std::max(fit.shiftSigma(0), fit.shiftSigma(1));
    return AlignedPatch{u + patch.off_grid_px, v, fit.ncc(), -step[3],
                        hypotenuse(sigma, static_cast<float>(kPatchSigmaFloor_px))};
  }
  return std::nullopt;
}

namespace {

/// The whole-pixel disparity with the smallest difference within the radius of the prediction. It is the prediction
/// itself when no window fits into the images.
double searchAround(const Image& left, const Image& right, double u_px, double v_px, double predicted_px,
                    double radius_px) {
  const int u = static_cast<int>(std::lround(u_px)), v = static_cast<int>(std::lround(v_px));
  const Window window{left, u, v, kFullSizeWindow};
  constexpr int kHalf_px = kFullSizeWindow.columns / 2;
  const int radius = static_cast<int>(std::ceil(radius_px));
  const int middle = static_cast<int>(std::lround(u_px - predicted_px));
  const int first = std::max(middle - radius, kHalf_px), last = std::min(middle + radius, right.width() - 1 - kHalf_px);
  if (last <= first || !window.insideImage()) return predicted_px;
  std::array<std::uint16_t, kMaxWindowCosts> costs;
  const auto searched = std::span(costs).first(std::min(last - first + 1, kMaxWindowCosts));
  windowDifferences(window, right, first, v, searched);
  const auto best = std::ranges::min_element(searched) - searched.begin();
  return u - (first + static_cast<double>(best));
}

/// The match where an alignment ended; empty when it does not fit or its disparity is too uncertain.
std::optional<StereoMatch> acceptedMatch(float disparity_px, const PatchTemplate& patch, const Moments& moments) {
  constexpr double kMinNcc = 0.65;
  constexpr float kMaxSigma_px = 1;
  const Fit fit(patch, moments);
  const float sigma = hypotenuse(fit.shiftSigma(0), static_cast<float>(kPatchSigmaFloor_px));
  if (fit.ncc() < kMinNcc || sigma > kMaxSigma_px || disparity_px <= 0) return std::nullopt;
  return StereoMatch{disparity_px, sigma};
}

}  // namespace

std::optional<StereoMatch> refine(const Image& left, const Image& right, double u_px, double v_px,
                                  double predicted_disparity_px, const DisparityParams& params) {
  const auto u = static_cast<float>(u_px), v = static_cast<float>(v_px);
  const auto patch = makeTemplate(left, u, v, kPatchWindow_px, PatchDeformation::kSlope);
  if (!patch) return std::nullopt;
  double start_px = predicted_disparity_px;
  if (params.search_radius_px > 0)
    start_px = searchAround(left, right, u_px, v_px, predicted_disparity_px, params.search_radius_px);

  constexpr float kConverged_px = 0.02F, kMaxShift_px = 2;
  constexpr int kHalf_px = kPatchWindow_px / 2;
  constexpr float kMaxSlope = static_cast<float>(kMaxShearShift_px) / static_cast<float>(kHalf_px);
  const Words mask = windowMask(kPatchWindow_px);
  float u_right = u - static_cast<float>(start_px), slope = 0;
  const float first_guess = u_right;
  for (int iteration = 0; iteration < kMaxDisparityIterations; ++iteration) {
    if (!inside(right, u_right, v)) return std::nullopt;
    const ColumnPosition u_grid(u_right);
    const Moments moments =
        slope == 0 ? momentsAt(*patch, mask, right, u_grid, v) : momentsAt(*patch, mask, right, u_grid, v, slope);
    if (moments.appearance() <= 0) return std::nullopt;
    const float gain = moments.appearance() / patch->norm;
    const FourFloats pull{0, 0, gain * patch->prior[1] * slope, 0};
    const FourFloats step = solve(*patch, moments.sums + pull) / allFour(gain);
    const float shift_px = std::clamp(step[1], -kMaxStep_px, kMaxStep_px);
    u_right = u_grid.px() - shift_px;
    slope = std::clamp(slope - step[2], -kMaxSlope, kMaxSlope);
    if (std::abs(u_right - first_guess) > kMaxShift_px) return std::nullopt;
    if (std::abs(shift_px) > kConverged_px && iteration + 1 < kMaxDisparityIterations) continue;

    return acceptedMatch(u - patch->off_grid_px - u_right, *patch, moments);
  }
  return std::nullopt;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(align);
MOTORCADE_EXPORT(refine);

std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, const Eigen::Vector2f& guess_px,
                                       const PatchParams& params) {
  return MOTORCADE_KERNEL(align)(patch, image, guess_px, params);
}

std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, const Eigen::Vector2f& point_px,
                                       const ImagePyramid& to, const Eigen::Vector2f& guess_px, int first_level,
                                       const PatchParams& params) {
  float u = guess_px.x(), v = guess_px.y();
  std::optional<AlignedPatch> aligned;
  for (int level = first_level; level >= 0; --level) {
    const auto patch = makeTemplate(from.levels[level], toLevel(point_px.x(), level), toLevel(point_px.y(), level),
                                    kPatchWindow_px, PatchDeformation::kScale);
    if (patch) aligned = alignPatch(*patch, to.levels[level], {toLevel(u, level), toLevel(v, level)}, params);
    if (!patch || !aligned) {
      if (level == 0) return std::nullopt;
      continue;  // without texture at a coarse level the guess stays as it is
    }
    u = fromLevel(aligned->u_px, level);
    v = fromLevel(aligned->v_px, level);
  }
  return aligned;
}

std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px,
                                           double predicted_disparity_px, const DisparityParams& params) {
  return MOTORCADE_KERNEL(refine)(left, right, u_px, v_px, predicted_disparity_px, params);
}

}  // namespace motorcade
#endif
