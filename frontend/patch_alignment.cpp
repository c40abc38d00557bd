#include "frontend/patch_alignment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include <Eigen/LU>

#include "frontend/image_pyramid.hpp"
#include "frontend/patch_sampling.hpp"
#include "frontend/window_differences.hpp"

namespace motorcade {
namespace {

constexpr int kStride = PatchTemplate::kStride;
constexpr int kMaxShearShift_px = 4;  // of a patch's first and last row against its middle
static_assert(kStride == kWordLanes && kMaxPatchWindow_px + 2 <= kWordLanes && kMaxPatchWindow_px + 3 <= kBlockRows);
static_assert(kMaxPatchWindow_px + 2 * kMaxShearShift_px + 2 + 24 <= kBlockStride);

// What the words of the planes and of the other image's samples count: their products' sums over the largest window fit 32 bits.
constexpr int kAppearanceShift = 2, kSampleShift = 3;  // from samples
constexpr float kAppearanceUnit = 1.0F / 16, kGradientUnit = 1.0F / 16, kMomentUnit = 1.0F / 4, kOtherUnit = 1.0F / 8;

/// Gray levels that a word of each derivative counts.
Eigen::Vector3f descentUnits(PatchDeformation deformation) {
  return {kGradientUnit, deformation == PatchDeformation::kScale ? kGradientUnit : kMomentUnit, kMomentUnit};
}

bool inside(const Image& image, float u_px, float v_px) {
  return u_px >= 0 && v_px >= 0 && u_px <= static_cast<float>(image.width() - 1) && v_px <= static_cast<float>(image.height() - 1);
}

/// `words` divided by 2^shift, rounded.
Words reduced(const Words& words, int shift) {
  return (words + allWords(1 << (shift - 1))) >> static_cast<std::int16_t>(shift);
}

/// Ones inside the window, zeros to its right.
Words windowMask(int window_px) {
  constexpr Words kColumns{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  return kColumns < allWords(window_px);  // minus one: all bits set
}

using Square = std::array<Words, kMaxPatchWindow_px + 2>;

/// Samples of a square around (u, v), the column as on the grid.
void sampleSquare(const Image& image, const GridPlace& u, float v_px, int side_px, Square& out) {
  const int half = side_px / 2;
  const RowPlace top(v_px - static_cast<float>(half));
  const Block block(image, u.pixel - half, top.pixel, side_px + 1, side_px + 1);
  const SampleColumns columns(u.fraction);
  const Words fraction = allWords(top.fraction);
  Words upper = columns(block.row(0));
  for (int r = 0; r < side_px; ++r) {
    const Words lower = columns(block.row(r + 1));
    out[static_cast<std::size_t>(r)] = betweenRows(upper, lower, fraction);
    upper = lower;
  }
}

/// The same with samples 1 / scale px apart; the scale is at least `kMinTemplateScale`.
void sampleScaledSquare(const Image& image, const GridPlace& u, float v_px, int side_px, float scale, Square& out) {
  const int half = side_px / 2;
  const float spacing_px = 1 / scale;
  const auto last_u = static_cast<float>(image.width() - 1), last_v = static_cast<float>(image.height() - 1);
  std::array<float, kWordLanes> places_px;
  for (int c = 0; c < kWordLanes; ++c)
    places_px[static_cast<std::size_t>(c)] = std::clamp(u.px() + static_cast<float>(c - half) * spacing_px, 0.0F, last_u);
  const SampleColumns columns(places_px, image.width() - 1);
  for (int r = 0; r < side_px; ++r) {
    const RowPlace v(std::clamp(v_px + static_cast<float>(r - half) * spacing_px, 0.0F, last_v));
    const int below = std::min(v.pixel + 1, image.height() - 1);
    out[static_cast<std::size_t>(r)] = betweenRows(columns(image.row(v.pixel)), columns(image.row(below)), allWords(v.fraction));
  }
}

/// What alignment needs to know of the other image's patch J.
struct Moments {
  float appearance = 0;     // sum(a J)
  Eigen::Vector3f descent;  // sum(D J)
  float variation = 0;      // sum((J - mean)^2)
};

/// Gathers the moments row by row; the other image's samples are taken relative to the template's mean.
class MomentSums {
 public:
  explicit MomentSums(const PatchTemplate& patch) : patch_(patch), mask_(windowMask(patch.window_px)), mean_(allWords(patch.mean)) {}

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
    moments.descent =
        patch_.descent_units.cwiseProduct(Eigen::Vector3f(static_cast<float>(d0), static_cast<float>(d1), static_cast<float>(d2))) -
        patch_.descent_mean * total - patch_.descent_along * moments.appearance;
    moments.variation =
        static_cast<float>(pixels * squares - std::int64_t{sum} * sum) * (kOtherUnit * kOtherUnit / static_cast<float>(pixels));
    return moments;
  }

 private:
  const PatchTemplate& patch_;
  Words mask_, mean_;
  WordSums appearance_{}, d0_{}, d1_{}, d2_{}, sum_{}, squares_{};
};

/// Moments of the patch at (u, v).
[[gnu::always_inline]] inline Moments momentsAt(const PatchTemplate& patch, const Image& image, const GridPlace& u, float v_px) {
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
  const int x = static_cast<int>(std::floor(left - reach)), end = static_cast<int>(std::floor(left + reach)) + window + 2;
  const Block block(image, x, top.pixel, end - x, window + 1);
  const Words fraction = allWords(top.fraction);
  MomentSums sums(patch);
  for (int r = 0; r < window; ++r) {
    const GridPlace row_left(left + shear * static_cast<float>(r - half) - static_cast<float>(x));
    const SampleColumns columns(row_left.fraction);
    sums.add(r, betweenRows(columns(block.row(r) + row_left.pixel), columns(block.row(r + 1) + row_left.pixel), fraction));
  }
  return sums.moments();
}

/// Mean of the window inside a square with a border of one, in samples.
int meanSample(const Square& square, int window_px) {
  const Words mask = windowMask(window_px);
  WordSums sums{};
  for (int r = 1; r <= window_px; ++r) sums += products(afterFirst(square[static_cast<std::size_t>(r)]) & mask, allWords(1));
  const int pixels = window_px * window_px;
  return (totals(sums, sums, sums, sums)[0] + pixels / 2) / pixels;
}

/// Sums over the window of a template's planes and of their products.
struct TemplateSums {
  WordSums appearance{}, d0{}, d1{}, d2{};
  WordSums appearance_squares{}, appearance_d0{}, appearance_d1{}, appearance_d2{};
  WordSums d00{}, d01{}, d02{}, d11{}, d12{}, d22{};

  void add(const Words& a, const Words& x, const Words& y, const Words& z) {
    const Words one = allWords(1);
    appearance += products(a, one), d0 += products(x, one), d1 += products(y, one), d2 += products(z, one);
    appearance_squares += products(a, a), appearance_d0 += products(a, x), appearance_d1 += products(a, y), appearance_d2 += products(a, z);
    d00 += products(x, x), d01 += products(x, y), d02 += products(x, z);
    d11 += products(y, y), d12 += products(y, z), d22 += products(z, z);
  }
};

/// Fills the planes from the samples.
TemplateSums fillPlanes(PatchTemplate& patch, const Square& square, PatchDeformation deformation) {
  const int window = patch.window_px, half = window / 2;
  const bool scale = deformation == PatchDeformation::kScale;
  const Words mask = windowMask(window), mean = allWords(patch.mean);
  constexpr int kMomentShift = 10;  // from differences of samples times pixels to `kMomentUnit`
  constexpr Words kColumns{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const Words columns = (kColumns - static_cast<std::int16_t>(half)) << static_cast<std::int16_t>(kMomentShift);
  TemplateSums sums;
  Words above = afterFirst(square[0]), here = afterFirst(square[1]);
  for (int r = 0; r < window; ++r) {
    const auto row = static_cast<std::size_t>(r);
    const Words& samples = square[row + 1];
    const Words below = afterFirst(square[row + 2]), rows = allWords((r - half) * (1 << kMomentShift));
    const Words du = (afterSecond(samples) - samples) & mask, dv = (below - above) & mask;  // of samples two pixels apart
    const Words a = reduced(here - mean, kAppearanceShift) & mask, d0 = reduced(du, 3);
    const Words d1 = scale ? reduced(dv, 3) : scaled(du, rows);
    const Words d2 = scale ? scaled(du, columns) + scaled(dv, rows) : scaled(du, columns);
    storeWords(patch.appearance.data() + r * kStride, a);
    storeWords(patch.descent[0].data() + r * kStride, d0);
    storeWords(patch.descent[1].data() + r * kStride, d1);
    storeWords(patch.descent[2].data() + r * kStride, d2);
    sums.add(a, d0, d1, d2);
    above = here;
    here = below;
  }
  return sums;
}

/// Completes a template from the sums over its planes: takes the mean out of the appearance, and the mean and the component along the
/// appearance out of the derivatives (a change of bias or gain is no motion). Returns the sums of products of the latter.
Eigen::Matrix3f orthogonalize(PatchTemplate& patch, const TemplateSums& sums, PatchDeformation deformation) {
  const auto plain = totals(sums.appearance, sums.d0, sums.d1, sums.d2);
  const auto along = totals(sums.appearance_squares, sums.appearance_d0, sums.appearance_d1, sums.appearance_d2);
  const auto first = totals(sums.d00, sums.d01, sums.d02, sums.d11), last = totals(sums.d12, sums.d22, sums.d12, sums.d22);
  const auto asFloat = [](std::int32_t x) { return static_cast<float>(x); };
  const float pixels = asFloat(patch.window_px * patch.window_px);
  const Eigen::Vector3f units = descentUnits(deformation);
  const Eigen::Vector3f sum_d = units.cwiseProduct(Eigen::Vector3f(asFloat(plain[1]), asFloat(plain[2]), asFloat(plain[3])));
  const Eigen::Vector3f sum_ad =
      kAppearanceUnit * units.cwiseProduct(Eigen::Vector3f(asFloat(along[1]), asFloat(along[2]), asFloat(along[3])));
  Eigen::Matrix3f sum_dd;
  sum_dd << asFloat(first[0]), asFloat(first[1]), asFloat(first[2]), asFloat(first[1]), asFloat(first[3]), asFloat(last[0]),
      asFloat(first[2]), asFloat(last[0]), asFloat(last[1]);
  sum_dd = units.asDiagonal() * sum_dd * units.asDiagonal();

  const float mean = kAppearanceUnit * asFloat(plain[0]) / pixels;
  patch.norm = std::sqrt(std::max(0.0F, kAppearanceUnit * kAppearanceUnit * asFloat(along[0]) - mean * mean * pixels));
  const float scale = patch.norm > 0 ? 1 / patch.norm : 0;
  patch.appearance_unit = scale * kAppearanceUnit * kOtherUnit;
  patch.appearance_mean = scale * mean;
  patch.descent_units = units * kOtherUnit;
  patch.descent_mean = sum_d / pixels;
  patch.descent_along = scale * (sum_ad - mean * sum_d);
  return sum_dd - sum_d * patch.descent_mean.transpose() - patch.descent_along * patch.descent_along.transpose();
}

/// Information of a deformation whose standard deviation is `sigma`, for the noise that 8-bit images have at least (3 gray levels).
constexpr float priorInformation(float sigma) { return 9 / (sigma * sigma); }
constexpr float kScaleSigma = 0.1F, kRowSlopeSigma = 0.3F, kColumnSlopeSigma = 0.15F;
constexpr float kMaxStep_px = 1.5F;    // the gain comes out too small, and the step too long, while the patches do not overlap well
/// An alignment whose steps are still as long as this at its fourth, fifth, ... iteration (the last counts for all that follow) comes to
/// nothing, but for one in a hundred.
constexpr std::array kLost_px{1.0F, 0.7F, 0.45F, 0.3F, 0.2F};
constexpr int kFirstLost = 3;
bool isLost(int iteration, float step_px2) {
  if (iteration < kFirstLost) return false;
  const float lost_px = kLost_px[std::min(static_cast<std::size_t>(iteration - kFirstLost), kLost_px.size() - 1)];
  return step_px2 > lost_px * lost_px;
}
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
  const GridPlace u(u_px);
  Square square;
  if (scale == 1) {
    sampleSquare(image, u, v_px, window_px + 2, square);
  } else {
    sampleScaledSquare(image, u, v_px, window_px + 2, scale, square);
  }
  patch.emplace();
  patch->window_px = window_px;
  patch->off_grid_px = u_px - u.px();
  patch->mean = meanSample(square, window_px);
  Eigen::Matrix3f hessian = orthogonalize(*patch, fillPlanes(*patch, square, deformation), deformation);
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
    return AlignedPatch{u + patch.off_grid_px, v, ncc, -step[2], std::hypot(sigma, static_cast<float>(params.sigma_floor_px))};
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
