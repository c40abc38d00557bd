#include "frontend/image/patch_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/image/patch_sampling.hpp"
#include "frontend/image/window_differences.hpp"

namespace motorcade {
namespace {

constexpr int kStride = PatchTemplate::kStride;
constexpr float kOtherUnit = PatchTemplate::kOtherUnit;
constexpr int kSampleShift = 3;       // from samples to words of the other image
constexpr int kMaxShearShift_px = 4;  // of a patch's first and last row against its middle
static_assert(kMaxPatchWindow_px + 2 * kMaxShearShift_px + 2 + 24 <= kBlockStride);

/// What alignment needs to know of the other image's patch J.
struct Moments {
  float appearance = 0;     // sum(a J)
  Eigen::Vector3f descent;  // sum(D J)
  float variation = 0;      // sum((J - mean)^2)
};

/// Gathers the moments row by row; the other image's samples are taken relative to the template's mean.
class MomentSums {
 public:
  explicit MomentSums(const PatchTemplate& patch)
      : patch_(patch), mask_(windowMask(patch.window_px)), mean_(allWords(patch.mean)) {}

  void add(int row, const Words& samples) {
    const Words j = reduced(samples - mean_, kSampleShift), inner = j & mask_;
    const auto plane = [&](const PatchTemplate::Plane& words) { return loadWords(words.data() + row * kStride); };
    appearance_ += products(plane(patch_.appearance), j);
    d0_ += products(plane(patch_.descent[0]), j);
    d1_ += products(plane(patch_.descent[1]), j);
    d2_ += products(plane(patch_.descent[2]), j);
    sum_ += products(inner, allWords(1));
    squares_ += products(inner, inner);
  }

  Moments moments() const {
    const auto [appearance, d0, d1, d2] = totals(appearance_, d0_, d1_, d2_);
    const auto [sum, squares, unused0, unused1] = totals(sum_, squares_, sum_, squares_);
    const std::int64_t pixels = patch_.window_px * patch_.window_px;
    const float total = static_cast<float>(sum) * kOtherUnit;
    Moments moments;
    moments.appearance = patch_.appearance_unit * static_cast<float>(appearance) - patch_.appearance_mean * total;
    moments.descent = patch_.descent_units.cwiseProduct(
                          Eigen::Vector3f(static_cast<float>(d0), static_cast<float>(d1), static_cast<float>(d2))) -
                      patch_.descent_mean * total - patch_.descent_along * moments.appearance;
    moments.variation = static_cast<float>(pixels * squares - std::int64_t{sum} * sum) *
                        (kOtherUnit * kOtherUnit / static_cast<float>(pixels));
    return moments;
  }

 private:
  const PatchTemplate& patch_;
  Words mask_, mean_;
  WordSums appearance_{}, d0_{}, d1_{}, d2_{}, sum_{}, squares_{};
};

/// Moments of the patch at (u, v).
[[gnu::always_inline]] inline Moments momentsAt(const PatchTemplate& patch, const Image& image, const GridPlace& u,
                                                float v_px) {
  const int window = patch.window_px, half = window / 2;
  const RowPlace top(v_px - static_cast<float>(half));
  const Block block(image, u.pixel - half, top.pixel, window + 1, window + 1);
  const SampleColumns columns(u.fraction);
  const Words fraction = allWords(top.fraction);
  MomentSums sums(patch);
  Words upper = columns(block.row(0));
  for (int r = 0; r < window; ++r) {
    const Words lower = columns(block.row(r + 1));
    sums.add(r, betweenRows(upper, lower, fraction));
    upper = lower;
  }
  return sums.moments();
}

/// The same with the rows shifted by `shear` px per row.
Moments momentsAt(const PatchTemplate& patch, const Image& image, const GridPlace& u, float v_px, float shear) {
  const int window = patch.window_px, half = window / 2;
  const float left = u.px() - static_cast<float>(half), reach = std::abs(shear) * static_cast<float>(half);
  const RowPlace top(v_px - static_cast<float>(half));
  const int x = static_cast<int>(std::floor(left - reach)),
            end = static_cast<int>(std::floor(left + reach)) + window + 2;
  const Block block(image, x, top.pixel, end - x, window + 1);
  const Words fraction = allWords(top.fraction);
  MomentSums sums(patch);
  for (int r = 0; r < window; ++r) {
    const GridPlace row_left(left + shear * static_cast<float>(r - half) - static_cast<float>(x));
    const SampleColumns columns(row_left.fraction);
    sums.add(r,
             betweenRows(columns(block.row(r) + row_left.pixel), columns(block.row(r + 1) + row_left.pixel), fraction));
  }
  return sums.moments();
}

constexpr float kMaxStep_px =
    1.5F;  // the gain comes out too small, and the step too long, while the patches do not overlap well

/// An alignment whose steps are still as long as this at its fourth, fifth, ... iteration (the last counts for all that
/// follow) comes to nothing, but for one in a hundred.
constexpr std::array kLost_px{1.0F, 0.7F, 0.45F, 0.3F, 0.2F};
constexpr int kFirstLost = 3;
bool isLost(int iteration, float step_px2) {
  if (iteration < kFirstLost) return false;
  const float lost_px = kLost_px[std::min(static_cast<std::size_t>(iteration - kFirstLost), kLost_px.size() - 1)];
  return step_px2 > lost_px * lost_px;
}

/// Share of the patch that template and deformation explain, as a correlation.
float explainedCorrelation(const PatchTemplate& patch, const Moments& moments) {
  if (moments.appearance <= 0 || moments.variation <= 0) return 0;
  const float deformation = moments.descent.dot(patch.inverse_hessian * moments.descent);
  return std::sqrt(std::min(1.0F, (moments.appearance * moments.appearance + deformation) / moments.variation));
}

/// Standard deviation of the shift along parameter i, from a residual taken as white. What that leaves out (noise in
/// the gradients of H, deformations beyond the model) is in the factor, fitted to the median error on rendered street
/// scenes.
constexpr float kSigmaFactor = 1.35F;
float shiftSigma(const PatchTemplate& patch, const Moments& moments, float ncc, int parameter) {
  const float gain = moments.appearance / patch.norm;
  const int freedom = patch.window_px * patch.window_px - 5;
  const float noise_variance = std::max(0.0F, moments.variation * (1 - ncc * ncc)) / static_cast<float>(freedom);
  return kSigmaFactor * std::sqrt(noise_variance * patch.inverse_hessian(parameter, parameter)) / gain;
}

}  // namespace

std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, float u_guess_px,
                                       float v_guess_px, const PatchParams& params) {
  const auto max_shift_px2 = static_cast<float>(params.max_shift_px * params.max_shift_px);
  float u = u_guess_px, v = v_guess_px;
  for (int iteration = 0; iteration < params.max_iterations; ++iteration) {
    if (!inside(image, u, v)) return std::nullopt;
    const GridPlace u_grid(u);
    const Moments moments = momentsAt(patch, image, u_grid, v);
    if (moments.appearance <= 0) return std::nullopt;
    Eigen::Vector3f step = patch.inverse_hessian * moments.descent * (patch.norm / moments.appearance);
    step *= std::min(1.0F, kMaxStep_px / step.head<2>().norm());
    u = u_grid.px() - step.x();
    v -= step.y();
    if ((u - u_guess_px) * (u - u_guess_px) + (v - v_guess_px) * (v - v_guess_px) > max_shift_px2) return std::nullopt;
    const float step_px2 = step.head<2>().squaredNorm();
    if (isLost(iteration, step_px2)) return std::nullopt;
    if (step_px2 > params.max_step_px * params.max_step_px) continue;
    const float ncc = explainedCorrelation(patch, moments);
    if (ncc < params.min_ncc) return std::nullopt;
    const float sigma = std::max(shiftSigma(patch, moments, ncc, 0), shiftSigma(patch, moments, ncc, 1));
    return AlignedPatch{u + patch.off_grid_px, v, ncc, -step[2],
                        std::hypot(sigma, static_cast<float>(params.sigma_floor_px))};
  }
  return std::nullopt;
}

std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, float u_px, float v_px, const ImagePyramid& to,
                                       float u_guess_px, float v_guess_px, int first_level, const PatchParams& params) {
  float u = u_guess_px, v = v_guess_px;
  std::optional<AlignedPatch> aligned;
  for (int level = first_level; level >= 0; --level) {
    const auto i = static_cast<std::size_t>(level);
    const auto patch = makeTemplate(from.levels[i], toLevel(u_px, level), toLevel(v_px, level), params.window_px,
                                    PatchDeformation::kScale);
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

namespace {

/// Whole-pixel disparity with the smallest difference within the radius of the prediction; the prediction when no
/// window fits.
double searchAround(const Image& left, const Image& right, double u_px, double v_px, double predicted_px,
                    double radius_px) {
  constexpr WindowSize kWindow;
  const int u = static_cast<int>(std::lround(u_px)), v = static_cast<int>(std::lround(v_px)),
            half = kWindow.columns / 2;
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

std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px,
                                           double predicted_disparity_px, const DisparityParams& params) {
  const auto u = static_cast<float>(u_px), v = static_cast<float>(v_px);
  const auto patch = makeTemplate(left, u, v, params.window_px, PatchDeformation::kSlope);
  if (!patch) return std::nullopt;
  double start_px = predicted_disparity_px;
  if (params.search_radius_px > 0)
    start_px = searchAround(left, right, u_px, v_px, predicted_disparity_px, params.search_radius_px);

  constexpr float kConverged_px = 0.02F, kMaxShift_px = 2;
  const int half = params.window_px / 2;
  const float max_slope = static_cast<float>(kMaxShearShift_px) / static_cast<float>(half);
  float u_right = u - static_cast<float>(start_px), slope = 0;
  const float first_guess = u_right;
  for (int iteration = 0; iteration < params.max_iterations; ++iteration) {
    if (!inside(right, u_right, v)) return std::nullopt;
    const GridPlace u_grid(u_right);
    const Moments moments = momentsAt(*patch, right, u_grid, v, slope);
    if (moments.appearance <= 0) return std::nullopt;
    const float gain = moments.appearance / patch->norm;
    const Eigen::Vector3f pull(0, gain * patch->prior[1] * slope, 0);
    Eigen::Vector3f step = patch->inverse_hessian * (moments.descent + pull) / gain;
    step[0] = std::clamp(step[0], -kMaxStep_px, kMaxStep_px);
    u_right = u_grid.px() - step[0];
    slope = std::clamp(slope - step[1], -max_slope, max_slope);
    if (std::abs(u_right - first_guess) > kMaxShift_px) return std::nullopt;
    if (std::abs(step[0]) > kConverged_px && iteration + 1 < params.max_iterations) continue;

    const float ncc = explainedCorrelation(*patch, moments);
    const float sigma = std::hypot(shiftSigma(*patch, moments, ncc, 0), static_cast<float>(params.sigma_floor_px));
    const float disparity_px = u - patch->off_grid_px - u_right;
    if (ncc < params.min_ncc || sigma > params.max_sigma_px || disparity_px <= 0) return std::nullopt;
    return StereoMatch{disparity_px, sigma};
  }
  return std::nullopt;
}

}  // namespace motorcade
