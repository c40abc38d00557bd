#include "apps/canvas/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <cairo.h>

#ifdef __SANITIZE_ADDRESS__
/// Fontconfig keeps patterns by offsets instead of pointers, which the leak checker cannot follow.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the name that the checker looks for
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
#endif

namespace motorcade {
namespace {

using Eigen::Vector2d;

constexpr double kMostCoordinate_px = 1e6;  // Cairo's own are fixed-point numbers of 24 bits

bool isDrawable(const Vector2d& at) { return at.allFinite() && at.cwiseAbs().maxCoeff() < kMostCoordinate_px; }

bool isDrawable(const Rectangle& rectangle) {
  return isDrawable(Vector2d(rectangle.left, rectangle.top)) &&
         isDrawable(Vector2d(rectangle.width, rectangle.height)) && rectangle.width > 0 && rectangle.height > 0;
}

void setColor(cairo_t* context, Color color, double opacity) {
  cairo_set_source_rgba(context, color.red / 255.0, color.green / 255.0, color.blue / 255.0, opacity);
}

/// Adds a path. It starts anew behind a point that cannot be drawn.
void addPath(cairo_t* context, Canvas::Points points) {
  bool begun = false;
  for (const Vector2d& at : points) {
    const bool drawable = isDrawable(at);
    if (drawable && begun)
      cairo_line_to(context, at.x(), at.y());
    else if (drawable)
      cairo_move_to(context, at.x(), at.y());
    begun = drawable;
  }
}

/// Strokes the path. Pieces of a translucent line must not overlap at their ends.
void stroke(cairo_t* context, const Pen& pen) {
  const bool butts = pen.opacity < 1 || !pen.dashes_px.empty();
  cairo_set_line_cap(context, butts ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_width(context, pen.width_px);
  cairo_set_dash(context, pen.dashes_px.data(), static_cast<int>(pen.dashes_px.size()), 0);
  setColor(context, pen.color, pen.opacity);
  cairo_stroke(context);
}

void fillPath(cairo_t* context, const Fill& fill) {
  setColor(context, fill.color, fill.opacity);
  cairo_fill(context);
}

void addRounded(cairo_t* context, const Rectangle& rectangle, double radius_px) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const double radius = std::clamp(radius_px, 0.0, 0.5 * std::min(rectangle.width, rectangle.height));
  cairo_new_sub_path(context);
  cairo_arc(context, rectangle.right() - radius, rectangle.top + radius, radius, -kQuarter, 0);
  cairo_arc(context, rectangle.right() - radius, rectangle.bottom() - radius, radius, 0, kQuarter);
  cairo_arc(context, rectangle.left + radius, rectangle.bottom() - radius, radius, kQuarter, 2 * kQuarter);
  cairo_arc(context, rectangle.left + radius, rectangle.top + radius, radius, 2 * kQuarter, 3 * kQuarter);
  cairo_close_path(context);
}

/// Selects the font without hinting, so that letters look the same at any position and on any machine.
void selectFont(cairo_t* context, const TextStyle& style) {
  cairo_select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, style.size_px);
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options);
  cairo_font_options_destroy(options);
}

/// Passes the text to `use` as glyphs. A text that is not UTF-8 would end all drawing on the context.
template <class Use>
void withGlyphs(cairo_t* context, std::string_view given, const Use& use) {
  std::string text(given);
  cairo_scaled_font_t* const font = cairo_get_scaled_font(context);
  for (const bool replaced : {false, true}) {
    if (replaced)
      std::ranges::replace_if(
          text, [](char letter) { return (letter & 0x80) != 0; }, '?');
    cairo_glyph_t* glyphs = nullptr;
    int count = 0;
    const cairo_status_t status = cairo_scaled_font_text_to_glyphs(
        font, 0, 0, text.c_str(), static_cast<int>(text.size()), &glyphs, &count, nullptr, nullptr, nullptr);
    if (status == CAIRO_STATUS_SUCCESS) use(font, glyphs, count);
    cairo_glyph_free(glyphs);
    if (status == CAIRO_STATUS_SUCCESS) return;
  }
}

/// Copies to Cairo's layout: blue, green, red and an unused byte.
void copyGray(const Image& image, std::uint8_t* to, int stride) {
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* gray = image.row(y);
    std::uint8_t* pixel = to + static_cast<std::ptrdiff_t>(y) * stride;
    for (int x = 0; x < image.width(); ++x, pixel += 4) pixel[0] = pixel[1] = pixel[2] = gray[x];
  }
}

}  // namespace

struct Canvas::Surface {
  cairo_surface_t* surface;
  cairo_t* context;

  explicit Surface(cairo_surface_t* made) : surface(made), context(cairo_create(made)) {
    const cairo_status_t status = cairo_status(context);
    if (status == CAIRO_STATUS_SUCCESS) {
      cairo_translate(context, 0.5, 0.5);
      return;
    }
    release();
    if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
    throw std::runtime_error(std::string("Cairo cannot make the picture: ") + cairo_status_to_string(status));
  }
  ~Surface() { release(); }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  void release() const {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }
};

Canvas::Canvas(std::unique_ptr<Surface> surface, int width, int height)
    : surface_(std::move(surface)), width_(width), height_(height) {}

Canvas::Canvas(int width, int height, Color background)
    : Canvas(std::make_unique<Surface>(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), width, height) {
  setColor(surface_->context, background, 1);
  cairo_paint(surface_->context);
}

Canvas::Canvas(const Image& image) : Canvas(image.width(), image.height(), {}) {
  cairo_surface_flush(surface_->surface);
  copyGray(image, cairo_image_surface_get_data(surface_->surface), cairo_image_surface_get_stride(surface_->surface));
  cairo_surface_mark_dirty(surface_->surface);
}

Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&& other) noexcept = default;
Canvas& Canvas::operator=(Canvas&& other) noexcept = default;

Canvas Canvas::part(int left, int top, int width, int height) {
  return {std::make_unique<Surface>(cairo_surface_create_for_rectangle(surface_->surface, left, top, width, height)),
          width, height};
}

void Canvas::line(const Vector2d& from, const Vector2d& to, const Pen& pen) {
  const std::array ends{from, to};
  polyline(ends, pen);
}

void Canvas::polyline(Points points, const Pen& pen) {
  addPath(surface_->context, points);
  stroke(surface_->context, pen);
}

void Canvas::outline(Points corners, const Pen& pen) {
  if (!std::ranges::all_of(corners, [](const Vector2d& at) { return isDrawable(at); })) return;
  addPath(surface_->context, corners);
  cairo_close_path(surface_->context);
  stroke(surface_->context, pen);
}

void Canvas::fill(Points corners, const Fill& fill) {
  if (!std::ranges::all_of(corners, [](const Vector2d& at) { return isDrawable(at); })) return;
  addPath(surface_->context, corners);
  fillPath(surface_->context, fill);
}

void Canvas::arrow(const Vector2d& from, const Vector2d& to, const Pen& pen) {
  const double length = (to - from).norm();
  if (!isDrawable(from) || !isDrawable(to) || !(length > 0)) return;
  const double head = std::min(3 + 3 * pen.width_px, length);
  const Vector2d along = (to - from) / length, across(-along.y(), along.x()), neck = to - head * along;
  Pen shaft = pen;
  shaft.opacity = std::min(pen.opacity, 0.999);  // with a blunt end, below the head
  line(from, neck + 0.5 * along, shaft);
  const std::array corners{to, Vector2d(neck + 0.42 * head * across), Vector2d(neck - 0.42 * head * across)};
  fill(corners, {pen.color, pen.opacity});
}

void Canvas::dot(const Vector2d& at, double radius_px, const Fill& fill) {
  if (!isDrawable(at)) return;
  cairo_new_sub_path(surface_->context);
  cairo_arc(surface_->context, at.x(), at.y(), radius_px, 0, 2 * std::numbers::pi);
  fillPath(surface_->context, fill);
}

void Canvas::fillRounded(const Rectangle& rectangle, double radius_px, const Fill& fill) {
  if (!isDrawable(rectangle)) return;
  addRounded(surface_->context, rectangle, radius_px);
  fillPath(surface_->context, fill);
}

void Canvas::text(const Vector2d& at, std::string_view text, const TextStyle& style) {
  if (!isDrawable(at)) return;
  cairo_t* const context = surface_->context;
  selectFont(context, style);
  setColor(context, style.color, 1);
  withGlyphs(context, text, [&](cairo_scaled_font_t*, cairo_glyph_t* glyphs, int count) {
    for (int i = 0; i < count; ++i) {
      glyphs[i].x += at.x();
      glyphs[i].y += at.y();
    }
    cairo_show_glyphs(context, glyphs, count);
  });
}

double Canvas::textWidth(std::string_view text, const TextStyle& style) {
  const Surface none(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1));
  selectFont(none.context, style);
  cairo_text_extents_t extents{};
  withGlyphs(none.context, text, [&](cairo_scaled_font_t* font, const cairo_glyph_t* glyphs, int count) {
    cairo_scaled_font_glyph_extents(font, glyphs, count, &extents);
  });
  return extents.x_advance;
}

void Canvas::paste(const Image& image, const Rectangle& to) {
  if (!isDrawable(to) || image.empty()) return;
  const Canvas source(image);
  cairo_t* const context = surface_->context;
  cairo_save(context);
  cairo_translate(context, to.left - 0.5, to.top - 0.5);
  cairo_scale(context, to.width / image.width(), to.height / image.height());
  cairo_set_source_surface(context, source.surface_->surface, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_GOOD);
  cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);
  cairo_rectangle(context, 0, 0, image.width(), image.height());
  cairo_fill(context);
  cairo_restore(context);
}

RgbImage Canvas::image() const {
  cairo_surface_flush(surface_->surface);
  RgbImage image{.width = width_, .height = height_, .pixels = {}};
  image.pixels.resize(std::size_t{3} * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  const std::uint8_t* const data = cairo_image_surface_get_data(surface_->surface);
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(surface_->surface);
  std::uint8_t* to = image.pixels.data();
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* from = data + y * stride;
    for (int x = 0; x < width_; ++x, from += 4, to += 3) {
      to[0] = from[2];
      to[1] = from[1];
      to[2] = from[0];
    }
  }
  return image;
}

std::vector<Vector2d> ellipse(const Vector2d& center, const Eigen::Matrix2d& axes) {
  constexpr int kCorners = 64;
  std::vector<Vector2d> corners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    corners.emplace_back(center + axes * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

}  // namespace motorcade
