#include "apps/draw/tags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/draw/palette.hpp"

namespace motorcade {
namespace {

constexpr double kMargin_px = 2;  // between labels

/// Places around the anchor, `gap` away from it: above is best, below is worst.
struct Candidate {
  double left, top, cost;
};

std::array<Candidate, 7> around(const LabelRequest& request, double gap) {
  const Rectangle& anchor = request.anchor;
  const double middle = anchor.middle().x() - 0.5 * request.width, above = anchor.top - gap - request.height,
               over_right = anchor.right() - request.width, right = anchor.right() + gap,
               left = anchor.left - gap - request.width;
  constexpr double kAside = 12, kBelow = 24;
  return {{{anchor.left, above, gap},
           {middle, above, gap + 1},
           {over_right, above, gap + 2},
           {right, anchor.top, gap + kAside},
           {left, anchor.top, gap + kAside + 1},
           {middle, anchor.bottom() + gap, gap + kBelow},
           {anchor.left, anchor.bottom() + gap, gap + kBelow + 1}}};
}

class Layout {
 public:
  Layout(std::span<const LabelRequest> requests, const Rectangle& area) : requests_(requests), area_(area) {}

  std::optional<Rectangle> place(const LabelRequest& request) {
    auto place = placeBeside(request);
    if (!place) place = placeAnywhere(request);
    if (place) placed_.push_back(*place);
    return place;
  }

 private:
  std::optional<Rectangle> placeBeside(const LabelRequest& request) const {
    constexpr double kFirst_px = 5, kStep_px = 6, kReach_px = 150;
    double least = std::numeric_limits<double>::infinity();
    std::optional<Rectangle> best;
    for (double gap = kFirst_px; gap < kReach_px; gap += kStep_px) {
      for (const Candidate& candidate : around(request, gap)) {
        const Rectangle place = movedInside(candidate, request);
        const double cost = candidate.cost + hiding(place) + shifted(candidate, place);
        if (!(cost < least) || !area_.contains(place) || meetsOther(place)) continue;
        least = cost;
        best = place;
      }
    }
    return best;
  }
  /// The nearest place of a coarse grid.
  std::optional<Rectangle> placeAnywhere(const LabelRequest& request) const {
    constexpr double kStep_px = 8;
    double least = std::numeric_limits<double>::infinity();
    std::optional<Rectangle> best;
    for (double top = area_.top; top + request.height <= area_.bottom(); top += kStep_px) {
      for (double left = area_.left; left + request.width <= area_.right(); left += kStep_px) {
        const Rectangle place{left, top, request.width, request.height};
        const double cost = (place.middle() - request.anchor.middle()).norm() + hiding(place);
        if (!(cost < least) || meetsOther(place)) continue;
        least = cost;
        best = place;
      }
    }
    return best;
  }
  Rectangle movedInside(const Candidate& candidate, const LabelRequest& request) const {
    const auto inside = [](double value, double least, double most) { return std::max(least, std::min(value, most)); };
    return {inside(candidate.left, area_.left, area_.right() - request.width),
            inside(candidate.top, area_.top, area_.bottom() - request.height), request.width, request.height};
  }
  static double shifted(const Candidate& candidate, const Rectangle& place) {
    return 0.5 * (std::abs(candidate.left - place.left) + std::abs(candidate.top - place.top));
  }
  /// Cost of the anchors' area that it would hide, in px of distance.
  double hiding(const Rectangle& place) const {
    constexpr double kPerPixel = 0.03;
    double hidden = 0;
    for (const LabelRequest& other : requests_) hidden += place.overlap(other.anchor);
    return kPerPixel * hidden;
  }
  bool meetsOther(const Rectangle& place) const {
    return std::ranges::any_of(placed_,
                               [&](const Rectangle& other) { return place.grownBy(kMargin_px).overlap(other) > 0; });
  }

  std::span<const LabelRequest> requests_;
  Rectangle area_;
  std::vector<Rectangle> placed_;
};

using Eigen::Vector2d;

constexpr double kTagEdge_px = 3, kPad_px = 6, kLine_px = 14, kAbove_px = 3;

TextStyle nameStyle(Color color) { return {.color = lightened(color), .size_px = 11.5, .bold = true}; }
const TextStyle kFacts{.color = kInk, .size_px = 11.5};

LabelRequest requestOf(const Tag& tag) {
  const double name = Canvas::textWidth(tag.name, nameStyle(tag.color)), facts = Canvas::textWidth(tag.facts, kFacts);
  const double lines = tag.facts.empty() ? 1 : 2;
  return {tag.anchor, std::ceil(std::max(name, facts) + kTagEdge_px + 2 * kPad_px), lines * kLine_px + 2 * kAbove_px};
}

/// Draws a line from the plate to the nearest point of its anchor.
void drawThread(Canvas& canvas, const Rectangle& plate, const Tag& tag) {
  constexpr double kNear_px = 9;
  const auto nearest = [](const Rectangle& in, const Vector2d& to) {
    return Vector2d(std::clamp(to.x(), in.left, in.right()), std::clamp(to.y(), in.top, in.bottom()));
  };
  const Vector2d from = nearest(plate, tag.anchor.middle()), to = nearest(tag.anchor, from);
  if ((to - from).norm() < kNear_px) return;
  canvas.line(from, to, {.color = kDark, .width_px = 3, .opacity = 0.5});
  canvas.line(from, to, {.color = tag.color, .width_px = 1.2});
}

void drawPlate(Canvas& canvas, const Rectangle& plate, const Tag& tag) {
  constexpr double kRadius_px = 4;
  canvas.fillRounded(plate, kRadius_px, {kDark, 0.84});
  canvas.fillRounded({plate.left + 3, plate.top + 4, kTagEdge_px, plate.height - 8}, kTagEdge_px / 2, {tag.color, 1});
  const Vector2d at(plate.left + kTagEdge_px + kPad_px, plate.top + kAbove_px + kLine_px - 3.5);
  canvas.text(at, tag.name, nameStyle(tag.color));
  canvas.text(at + Vector2d(0, kLine_px), tag.facts, kFacts);
}

}  // namespace

std::vector<std::optional<Rectangle>> placeLabels(std::span<const LabelRequest> requests, const Rectangle& area) {
  Layout layout(requests, area);
  std::vector<std::optional<Rectangle>> places;
  for (const LabelRequest& request : requests) places.push_back(layout.place(request));
  return places;
}

std::vector<Rectangle> paintTags(Sheet& sheet, const std::vector<Tag>& tags) {
  constexpr double kBorder_px = 3;
  std::vector<LabelRequest> requests;
  for (const Tag& tag : tags) requests.push_back(requestOf(tag));
  const auto places = placeLabels(requests, sheet.area().grownBy(-kBorder_px));
  for (std::size_t i = 0; i < tags.size(); ++i)
    if (places[i]) drawThread(sheet.canvas, *places[i], tags[i]);
  std::vector<Rectangle> plates;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!places[i]) continue;
    drawPlate(sheet.canvas, *places[i], tags[i]);
    if (tags[i].facts.find("±") != std::string::npos) sheet.marks.insert(Mark::kTag);
    plates.push_back(*places[i]);
  }
  return plates;
}

}  // namespace motorcade
