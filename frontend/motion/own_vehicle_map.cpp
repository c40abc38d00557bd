#include "frontend/motion/own_vehicle_map.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace motorcade {
namespace {

constexpr int kSureScore = 10;  // votes that make a cell part of the own vehicle
constexpr int kMostScore = 20;  // so that a cell that is seen through later is given up after as many votes
constexpr int kLeastScore = -10;
constexpr int kSeenThroughScore = -3;  // seen through: more than one mismatched point said so
constexpr int kReach_cells = 2;        // parts of one vehicle are this near: points on weak texture are sparse
constexpr int kMargin_cells = 1;
constexpr int kNear_cells = 4;  // as far as points on the road go down in the image from frame to frame, about

}  // namespace

OwnVehicleMap::OwnVehicleMap(const StereoCamera& camera)
    : camera_(camera),
      columns_((camera.width_px + kCell_px - 1) / kCell_px),
      rows_((camera.height_px + kCell_px - 1) / kCell_px),
      ballot_(static_cast<std::size_t>(columns_) * rows_, 0),
      score_(ballot_.size(), 0),
      sure_(ballot_),
      masked_(ballot_),
      near_votes_(ballot_) {}

int OwnVehicleMap::cellAt(double u_px, double v_px) const {
  const int column = std::clamp(static_cast<int>(u_px) / kCell_px, 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(v_px) / kCell_px, 0, rows_ - 1);
  return row * columns_ + column;
}

/// Calls act(column, row) for the cells at most `reach` away in either direction, the cell itself among them.
template <class Act>
void OwnVehicleMap::forEachAround(Cell cell, int reach, const Act& act) const {
  for (int row = std::max(0, cell.row - reach); row <= std::min(rows_ - 1, cell.row + reach); ++row)
    for (int column = std::max(0, cell.column - reach); column <= std::min(columns_ - 1, cell.column + reach); ++column)
      act(column, row);
}

void OwnVehicleMap::vote(double u_px, double v_px, Ballot ballot) {
  ballot_[cellAt(u_px, v_px)] |= ballot;
  voted_ = true;
}

void OwnVehicleMap::discard() {
  if (std::exchange(voted_, false)) std::ranges::fill(ballot_, 0);
}

void OwnVehicleMap::count() {
  if (!voted_) return;
  bool changed = false;
  for (int i = 0; i < std::ssize(ballot_); ++i) {
    if (ballot_[i] == 0) continue;
    const int before = score_[i];
    score_[i] = std::clamp(before + ((ballot_[i] & kAgainst) != 0 ? -1 : 1), kLeastScore, kMostScore);
    if (score_[i] > 0 && before <= 0) {
      any_votes_ = true;
      forEachAround({i % columns_, i / columns_}, kNear_cells,
                    [&](int c, int r) { near_votes_[r * columns_ + c] = 1; });
    }
    const bool sure = score_[i] >= kSureScore || (sure_[i] != 0 && score_[i] > 0);
    changed |= sure != (sure_[i] != 0) || (score_[i] <= kSeenThroughScore) != (before <= kSeenThroughScore);
    sure_[i] = sure ? 1 : 0;
  }
  discard();
  if (changed) mask();
}

void OwnVehicleMap::mask() {
  std::ranges::fill(masked_, 0);
  Cells sure = sure_;
  for (int i = 0; i < std::ssize(sure); ++i) {
    if (sure[i] == 0) continue;
    const auto part = takeConnected(sure, {i % columns_, i / columns_});
    if (const auto border = borderOf(part))
      for (const Cell& each : part) fill(each, *border);
  }
  view_.reset();
  if (std::ranges::find(masked_, 1) != masked_.end()) view_ = describe();
}

/// Takes the sure cells that hang together with the first one out of `sure`.
std::vector<OwnVehicleMap::Cell> OwnVehicleMap::takeConnected(Cells& sure, Cell first) const {
  std::vector<Cell> part{first};
  sure[first.row * columns_ + first.column] = 0;
  for (std::size_t i = 0; i < part.size(); ++i)
    forEachAround(Cell(part[i]), kReach_cells, [&](int column, int row) {
      std::uint8_t& is_sure = sure[row * columns_ + column];
      if (is_sure != 0) part.push_back({column, row});
      is_sure = 0;
    });
  return part;
}

/// Border at which a part of the own vehicle enters the image; empty where it reaches none. A hood reaches the sides,
/// too.
std::optional<OwnVehicleMap::Border> OwnVehicleMap::borderOf(const std::vector<Cell>& part) const {
  const auto reaches = [&](const auto& distance) {
    return std::ranges::any_of(part, [&](const Cell& cell) { return distance(cell) <= kReach_cells; });
  };
  if (reaches([&](const Cell& cell) { return rows_ - 1 - cell.row; })) return Border::kBottom;
  if (reaches([&](const Cell& cell) { return cell.column; })) return Border::kLeft;
  if (reaches([&](const Cell& cell) { return columns_ - 1 - cell.column; })) return Border::kRight;
  if (reaches([&](const Cell& cell) { return cell.row; })) return Border::kTop;
  return std::nullopt;
}

/// Masks a cell, the cells between it and the border, and those around these that are not seen through.
void OwnVehicleMap::fill(Cell cell, Border border) {
  const int across = border == Border::kLeft ? -1 : border == Border::kRight ? 1 : 0;
  const int down = border == Border::kTop ? -1 : border == Border::kBottom ? 1 : 0;
  for (; cell.column >= 0 && cell.column < columns_ && cell.row >= 0 && cell.row < rows_;
       cell.column += across, cell.row += down) {
    masked_[cell.row * columns_ + cell.column] = 1;
    forEachAround(cell, kMargin_cells, [&](int column, int row) {
      const int i = row * columns_ + column;
      if ((row - cell.row) * down + (column - cell.column) * across < 0) return;
      if (score_[i] > kSeenThroughScore) masked_[i] = 1;
    });
  }
}

OwnVehicleView OwnVehicleMap::describe() const {
  OwnVehicleView view{.share = 0,
                      .box = {static_cast<double>(camera_.width_px), static_cast<double>(camera_.height_px), 0, 0}};
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (masked_[row * columns_ + column] == 0) continue;
      const int left = column * kCell_px, right = std::min(left + kCell_px, camera_.width_px) - 1;
      const int top = row * kCell_px, bottom = std::min(top + kCell_px, camera_.height_px) - 1;
      view.share += static_cast<double>(right - left + 1) * (bottom - top + 1);
      view.box = {std::min<double>(view.box.left_px, left), std::min<double>(view.box.top_px, top),
                  std::max<double>(view.box.right_px, right), std::max<double>(view.box.bottom_px, bottom)};
    }
  }
  view.share /= static_cast<double>(camera_.width_px) * camera_.height_px;
  return view;
}

}  // namespace motorcade
