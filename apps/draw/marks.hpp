#pragma once

#include <set>

#include "apps/canvas/canvas.hpp"

namespace motorcade {

/// Kinds of marks in pictures, in the order of their legend.
enum class Mark {
  kMask,
  kCuboid,
  kBox,
  kPredicted,
  kPoint,
  kWay,
  kEarlierWay,
  kMotion,
  kTag,
  kFootprint,
  kEllipse,
  kOwnCamera,
  kOwnPath,
  kTrueMover,
  kTrueParked,
  kTruePath,
};
using Marks = std::set<Mark>;

/// A canvas, and which marks were put on it where they can be seen.
struct Sheet {
  Canvas& canvas;
  Marks& marks;

  Rectangle area() const { return {0, 0, canvas.width() - 1.0, canvas.height() - 1.0}; }
  /// Notes the mark for the legend if some of its points' line can be seen, and returns whether it can.
  bool note(Mark mark, Canvas::Points points);
};

/// The room that a legend of all marks needs.
int legendHeight(int width);
/// A sample and a word for each mark.
void drawLegend(Canvas& canvas, const Marks& marks);

}  // namespace motorcade
