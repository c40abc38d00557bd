#include "frontend/image/patch_template.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/image/patch_template.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/patch_sampling.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kStride = PatchTemplate::kStride;
constexpr float kOtherUnit = PatchTemplate::kOtherUnit;
static_assert(kStride == kWordLanes && kMaxPatchWindow_px + 2 <= kWordLanes && kMaxPatchWindow_px + 3 <= kBlockRows);

// Units of the words of the planes: the sums of their products with the other image's words, over the largest window,
// fit 32 bits.
constexpr int kAppearanceShift = 2;  // from samples
constexpr int kGradientShift = 3;    // from differences of samples two pixels apart
constexpr float kAppearanceUnit = 1.0F / 16, kGradientUnit = 1.0F / 16, kMomentUnit = 1.0F / 4;

/// Gray levels that a word of the appearance and of each derivative counts.
FourFloats unitsOf(PatchDeformation deformation) {
  return FourFloats{kAppearanceUnit, kGradientUnit,
                    deformation == PatchDeformation::kScale ? kGradientUnit : kMomentUnit, kMomentUnit};
}

/// Samples of a square, row by row, and what may be read after them.
using Square = std::array<std::int16_t, (kMaxPatchWindow_px + 3) * kStride>;

/// Samples a square around (u, v).
void sampleSquare(const Image& image, const ColumnPosition& u, float v_px, int side_px, Square& out) {
  const int half = side_px / 2;
  const RowPosition top(v_px - static_cast<float>(half));
  const Block block(image, u.pixel - half, top.pixel, side_px + 1, side_px + 1);
  const SampleColumns columns(allWords(SampleColumns::weightsOf(u.fraction)));
  const Words fraction = allWords(top.fraction);
  Words upper = columns(block.row(0));
  for (int r = 0; r < side_px; ++r) {
    const Words lower = columns(block.row(r + 1));
    store(out.data() + r * kStride, betweenRows(upper, lower, fraction));
    upper = lower;
  }
}

/// Samples a square with samples 1 / scale px apart. The scale is at least `kMinTemplateScale`.
void sampleScaledSquare(const Image& image, const ColumnPosition& u, float v_px, int side_px, float scale,
                        Square& out) {
  const int half = side_px / 2;
  const float spacing_px = 1 / scale;
  const auto last_u = static_cast<float>(image.width() - 1), last_v = static_cast<float>(image.height() - 1);
  std::array<float, kWordLanes> positions_px;
  for (int c = 0; c < kWordLanes; ++c)
    positions_px[c] = std::clamp(u.px() + static_cast<float>(c - half) * spacing_px, 0.0F, last_u);
  const SampleColumns columns(positions_px, image.width() - 1);
  for (int r = 0; r < side_px; ++r) {
    const RowPosition v(std::clamp(v_px + static_cast<float>(r - half) * spacing_px, 0.0F, last_v));
    const int below = std::min(v.pixel + 1, image.height() - 1);
    store(out.data() + r * kStride,
          betweenRows(columns(image.row(v.pixel)), columns(image.row(below)), allWords(v.fraction)));
  }
}

/// Mean of the window inside a square with a border of one, in samples.
int meanSample(const Square& square, int window_px) {
  const Words inner = windowMask(window_px + 1) - windowMask(1);  // minus one in the window's columns
  WordSums sums{};
  for (int r = 1; r <= window_px; ++r) sums -= products(load(square.data() + r * kStride), inner);
  const int pixels = window_px * window_px;
  return (total(sums) + pixels / 2) / pixels;
}

/// Fills the planes from the samples.
void fillPlanes(PatchTemplate& patch, const Square& square, PatchDeformation deformation) {
  const int window = patch.window_px, half = window / 2;
  const bool scale = deformation == PatchDeformation::kScale;
  const Words mask = windowMask(window);
  const Words rounding_mean = allWords(patch.mean - (1 << (kAppearanceShift - 1)));  // half a unit below the mean
  constexpr int kMomentShift = 10;  // from differences of samples times pixels to `kMomentUnit`
  const Words columns = (wordNumbers() - allWords(half)) << kMomentShift;
  // What is to the right of the window is masked.
  const auto samplesAt = [&](int row, int column) HWY_ATTR { return load(square.data() + row * kStride + column); };
  Words above = samplesAt(0, 1), here = samplesAt(1, 1);
  for (int r = 0; r < window; ++r) {
    const Words below = samplesAt(r + 2, 1), rows = allWords((r - half) * (1 << kMomentShift));
    // Differences of samples two pixels apart.
    const Words du = (samplesAt(r + 1, 2) - samplesAt(r + 1, 0)) & mask, dv = (below - above) & mask;
    const Words a = ((here - rounding_mean) >> kAppearanceShift) & mask;
    store(patch.appearance.data() + r * kStride, a);
    store(patch.descent[0].data() + r * kStride, reduced(du, kGradientShift));
    store(patch.descent[1].data() + r * kStride, scale ? reduced(dv, kGradientShift) : scaled(du, rows));
    store(patch.descent[2].data() + r * kStride, scale ? scaled(du, columns) + scaled(dv, rows) : scaled(du, columns));
    above = here;
    here = below;
  }
}

/// Sums over the window of a template's planes and of their products. They are gathered in two passes, as the sums of
/// each fit the registers.
struct TemplateSums {
  // The shift's derivatives are below 2048, and those with respect to a row's slope below 512 times the row's distance
  // from the middle: a word holds the sum of a column.
  Words d0{}, d1{};
  WordSums appearance{}, d2{};
  WordSums appearance_squares{}, appearance_d0{}, appearance_d1{}, appearance_d2{};
  WordSums d00{}, d01{}, d02{}, d11{}, d12{}, d22{};

  explicit TemplateSums(const PatchTemplate& patch) {
    const auto row = [](const PatchTemplate::Plane& plane, int r) HWY_ATTR { return load(plane.data() + r * kStride); };
    const auto& [plane0, plane1, plane2] = patch.descent;
    const Words one = allWords(1);
    for (int r = 0; r < patch.window_px; ++r) {
      const Words a = row(patch.appearance, r), x = row(plane0, r), y = row(plane1, r), z = row(plane2, r);
      d0 += x, d1 += y;
      appearance += products(a, one), d2 += products(z, one);
      appearance_squares += products(a, a), appearance_d0 += products(a, x), appearance_d1 += products(a, y),
          appearance_d2 += products(a, z);
    }
    for (int r = 0; r < patch.window_px; ++r) {
      const Words x = row(plane0, r), y = row(plane1, r), z = row(plane2, r);
      d00 += products(x, x), d01 += products(x, y), d02 += products(x, z);
      d11 += products(y, y), d12 += products(y, z), d22 += products(z, z);
    }
  }
};

/// A symmetric matrix, but for rounding: its rows, each behind a zero.
using Rows = std::array<FourFloats, 3>;

FourFloats asFloats(const FourSums& sums) { return __builtin_convertvector(sums, FourFloats); }
FourFloats withFirst(float first, FourFloats four) {
  four[0] = first;
  return four;
}

/// The sums of products of the derivatives.
Rows productSums(const TemplateSums& sums, const FourFloats& units) {
  const FourSums none{};
  const FourSums first = totals(sums.d00, sums.d01, sums.d02, sums.d11),
                 last = totals(sums.d12, sums.d22, sums.d12, sums.d22);
  const FourSums last_none = __builtin_shufflevector(last, none, 4, 0, 1, 4);  // zero, d12, d22, zero
  const FourFloats row0 = asFloats(__builtin_shufflevector(first, none, 4, 0, 1, 2)),
                   row1 = asFloats(__builtin_shufflevector(first, last_none, 4, 1, 3, 5)),
                   row2 = asFloats(__builtin_shufflevector(first, last_none, 4, 2, 5, 6));
  return {units[1] * row0 * units, units[2] * row1 * units, units[3] * row2 * units};
}

/// Completes a template from the sums over its planes. Takes the mean out of the appearance, and the mean and the
/// component along the appearance out of the derivatives, because a change of bias or gain is no motion. Returns the
/// sums of products of the derivatives.
Rows orthogonalize(PatchTemplate& patch, const TemplateSums& sums, PatchDeformation deformation) {
  const Words one = allWords(1);
  const FourFloats units = unitsOf(deformation),
                   all_pixels = allFour(static_cast<float>(patch.window_px * patch.window_px));
  const FourFloats plain =
      units * asFloats(totals(sums.appearance, products(sums.d0, one), products(sums.d1, one), sums.d2));
  const FourFloats along =
      kAppearanceUnit * units *
      asFloats(totals(sums.appearance_squares, sums.appearance_d0, sums.appearance_d1, sums.appearance_d2));
  const FourFloats means = plain / all_pixels;
  const float mean = means[0];
  patch.norm = std::sqrt(std::max(0.0F, along[0] - mean * mean * all_pixels[0]));
  const float scale = patch.norm > 0 ? 1 / patch.norm : 0;
  patch.units = withFirst(scale * kAppearanceUnit, units) * kOtherUnit;
  patch.means = withFirst(scale * mean, means);
  patch.along = withFirst(0, scale * (along - mean * plain));
  Rows rows = productSums(sums, units);
  const FourFloats mean_d = withFirst(0, means);
  for (int i = 0; i < 3; ++i) rows[i] = rows[i] - plain[i + 1] * mean_d - patch.along[i + 1] * patch.along;
  return rows;
}

FourFloats cross(const FourFloats& a, const FourFloats& b) {
  const auto next = [](const FourFloats& x) HWY_ATTR { return __builtin_shufflevector(x, x, 0, 2, 3, 1); };
  const auto last = [](const FourFloats& x) HWY_ATTR { return __builtin_shufflevector(x, x, 0, 3, 1, 2); };
  return next(a) * last(b) - last(a) * next(b);
}

/// Columns of the inverse, each behind a zero.
Rows inverseOf(const Rows& rows) {
  const Rows cofactors{cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])};
  const float determinant =
      cofactors[0][1] * rows[0][1] + (cofactors[1][1] * rows[1][1] + cofactors[2][1] * rows[2][1]);
  const float scale = 1 / determinant;
  return {cofactors[0] * scale, cofactors[1] * scale, cofactors[2] * scale};
}

/// Information of a deformation whose standard deviation is `sigma`, in units of the noise of 8-bit images (at least 3
/// gray levels).
constexpr float kNoise = 3;
constexpr float priorInformation(float sigma) { return kNoise * kNoise / (sigma * sigma); }
constexpr float kScaleSigma = 0.1F, kRowSlopeSigma = 0.3F, kColumnSlopeSigma = 0.15F;
/// Least information of the shift: a root mean square gradient of 0.7 gray levels per pixel over 11x11.
constexpr float kMinInformation = 60;

}  // namespace

std::optional<PatchTemplate> make(const Image& image, float u_px, float v_px, int window_px,
                                  PatchDeformation deformation, float scale) {
  assert(window_px % 2 == 1 && window_px <= kMaxPatchWindow_px);
  // The only object returned, so that it is never copied. (An empty one would be cleared first.)
  std::optional<PatchTemplate> patch(std::in_place);
  if (!inside(image, u_px, v_px) || scale < kMinTemplateScale) {
    patch.reset();
    return patch;
  }
  const ColumnPosition u(u_px);
  Square square;
  store(square.data() + (window_px + 2) * kStride, Words{});
  if (scale == 1) {
    sampleSquare(image, u, v_px, window_px + 2, square);
  } else {
    sampleScaledSquare(image, u, v_px, window_px + 2, scale, square);
  }
  patch->window_px = window_px;
  patch->off_grid_px = u_px - u.px();
  patch->mean = meanSample(square, window_px);
  fillPlanes(*patch, square, deformation);
  Rows hessian = orthogonalize(*patch, TemplateSums(*patch), deformation);
  bool textured = false;
  if (deformation == PatchDeformation::kScale) {
    patch->prior = {0, 0, priorInformation(kScaleSigma)};
    const float uu = hessian[0][1], uv = hessian[0][2], vu = hessian[1][1], vv = hessian[1][2];
    textured = uu * vv - vu * uv > kMinInformation * (uu + vv);
  } else {
    patch->prior = {0, priorInformation(kRowSlopeSigma), priorInformation(kColumnSlopeSigma)};
    textured = hessian[0][1] > kMinInformation;
  }
  hessian[1] += FourFloats{0, 0, patch->prior[1], 0};
  hessian[2] += FourFloats{0, 0, 0, patch->prior[2]};
  patch->inverse_hessian = inverseOf(hessian);
  if (!textured) patch.reset();
  return patch;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(make);

std::optional<PatchTemplate> makeTemplate(const Image& image, float u_px, float v_px, int window_px,
                                          PatchDeformation deformation, float scale) {
  return MOTORCADE_KERNEL(make)(image, u_px, v_px, window_px, deformation, scale);
}

}  // namespace motorcade
#endif
