#include "apps/draw/tags.hpp"

#include <algorithm>
#include <cmath>

#include "apps/draw/label_layout.hpp"
#include "apps/draw/palette.hpp"

namespace motorcade {
namespace {

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
