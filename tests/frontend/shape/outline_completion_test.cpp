#include "frontend/shape/outline_completion.hpp"

#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kLabelledWidth_px = 200, kLabelledHeight_px = 120;
constexpr int kCoarse = 1;  // level of the cells
constexpr PixelWindow kInside{.u0 = 20, .v0 = 10, .width = 40, .height = 30};
constexpr PixelWindow kOwn{.u0 = 30, .v0 = 15, .width = 12, .height = 10};  // what the outline covers

bool holds(const PixelWindow& cells, int u, int v) {
  return u >= cells.u0 && v >= cells.v0 && u < cells.u0 + cells.width && v < cells.v0 + cells.height;
}

PixelWindow displaced(PixelWindow cells, int right, int down) {
  cells.u0 += right, cells.v0 += down;
  return cells;
}

/// An outline found in a window, both in cells of a level, and the outline by labels.
struct Labelling {
  explicit Labelling(const PixelWindow& window = kInside, const PixelWindow& own = kOwn) : outline{window, {}} {
    seen.level = kCoarse;
    seen.map.window = window;
    for (int row = 0; row < window.height; ++row)
      for (int column = 0; column < window.width; ++column)
        outline.inside.push_back(holds(own, window.u0 + column, window.v0 + row) ? 1 : 0);
  }
  Labelling& add(std::uint16_t label, const PixelWindow& cells) {
    for (int v = 0; v < kLabelledHeight_px; ++v)
      for (int u = 0; u < kLabelledWidth_px; ++u)
        if (holds(cells, u >> kCoarse, v >> kCoarse)) labels.mutableRow(v)[u] = label;
    return *this;
  }
  std::optional<Outline> labelled() const { return labelledOutline(outline, seen, labels); }
  bool isLabelled() const { return labelled().has_value(); }

  Outline outline;
  LevelDisparities seen;
  InstanceLabels labels{kLabelledWidth_px, kLabelledHeight_px};
};

TEST(InstanceOutline, IsThatOfTheLabelThatAgrees) {
  constexpr PixelWindow kLabelled{.u0 = 31, .v0 = 14, .width = 12, .height = 11};
  Labelling labelling;
  labelling.add(4, {.u0 = 43, .v0 = 14, .width = 8, .height = 20}).add(7, kLabelled);
  labelling.add(9, {.u0 = 22, .v0 = 12, .width = 6, .height = 8});
  const auto labelled = labelling.labelled();
  ASSERT_TRUE(labelled);
  EXPECT_EQ(labelled->window.u0, kInside.u0);
  EXPECT_EQ(labelled->window.v0, kInside.v0);
  ASSERT_EQ(labelled->inside.size(), labelling.outline.inside.size());
  for (int row = 0; row < kInside.height; ++row)
    for (int column = 0; column < kInside.width; ++column)
      EXPECT_EQ(labelled->at(column, row), holds(kLabelled, kInside.u0 + column, kInside.v0 + row))
          << column << " " << row;
}

TEST(InstanceOutline, IsEmptyWhereNoLabelSharesMoreThanHalf) {
  EXPECT_FALSE(Labelling().isLabelled());
  EXPECT_TRUE(Labelling().add(7, kOwn).isLabelled());
  // Moved aside by 3 and 4 of 12 columns, both cover 9 of 15 and 8 of 16 of what either does.
  for (const int side : {-1, 1}) {
    EXPECT_TRUE(Labelling().add(7, displaced(kOwn, 3 * side, 0)).isLabelled());
    EXPECT_FALSE(Labelling().add(7, displaced(kOwn, 4 * side, 0)).isLabelled());
  }
  EXPECT_FALSE(Labelling().add(7, displaced(kOwn, 0, 20)).isLabelled());
  PixelWindow half = kOwn, twice = kOwn;
  half.height /= 2, twice.height *= 2;
  EXPECT_FALSE(Labelling().add(7, half).isLabelled());
  EXPECT_FALSE(Labelling().add(7, twice).isLabelled());
  ++half.height, --twice.height;
  EXPECT_TRUE(Labelling().add(7, half).isLabelled());
  EXPECT_TRUE(Labelling().add(7, twice).isLabelled());
}

TEST(InstanceOutline, IsNotPutTogetherOfTwoLabels) {
  PixelWindow left = kOwn, right = kOwn;
  left.width = 6, right.u0 += 6, right.width = 6;
  EXPECT_FALSE(Labelling().add(7, left).add(8, right).isLabelled());
}

/// The outline reaches to the window's border, and the label goes as far and on beyond it.
TEST(InstanceOutline, IsEmptyWhereTheLabelGoesOnBeyondTheWindow) {
  struct Side {
    const char* name;
    PixelWindow at_border, one_off;
  };
  for (const Side& side :
       {Side{"left", {20, 15, 12, 10}, {21, 15, 12, 10}}, Side{"right", {48, 15, 12, 10}, {47, 15, 12, 10}},
        Side{"top", {30, 10, 12, 10}, {30, 11, 12, 10}}, Side{"bottom", {30, 30, 12, 10}, {30, 29, 12, 10}}}) {
    EXPECT_FALSE(Labelling(kInside, side.at_border).add(7, side.at_border).isLabelled()) << side.name;
    EXPECT_TRUE(Labelling(kInside, side.at_border).add(7, side.one_off).isLabelled()) << side.name;
  }
}

TEST(InstanceOutline, MayEndAtTheImagesBorder) {
  constexpr int kColumns = kLabelledWidth_px >> kCoarse, kRows = kLabelledHeight_px >> kCoarse;
  struct Corner {
    const char* name;
    PixelWindow window, own;
  };
  for (const Corner& corner :
       {Corner{"upper left", {0, 0, 30, 30}, {0, 0, 12, 10}},
        Corner{"lower right", {kColumns - 30, kRows - 30, 30, 30}, {kColumns - 12, kRows - 10, 12, 10}}})
    EXPECT_TRUE(Labelling(corner.window, corner.own).add(7, corner.own).isLabelled()) << corner.name;
}

}  // namespace
}  // namespace motorcade
