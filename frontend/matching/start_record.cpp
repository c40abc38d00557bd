#include "frontend/matching/start_record.hpp"

namespace motorcade {
namespace {

constexpr int kCell_px = 24;
constexpr float kMemory = 0.8F;  // of what is remembered, from frame to frame

/// Of the points that start, by the rule of succession (one that was followed and one that was not are added). A third
/// is followed usually. Of those that this bound leaves out, one of ten would have been, and mostly for a frame or two;
/// with 0.3 the camera's paths become worse.
constexpr float kMinShare = 0.2F;

int columnsOf(int width) { return width / kCell_px + 1; }

}  // namespace

std::size_t StartRecord::cellAt(float u_px, float v_px) const {
  return static_cast<std::size_t>(static_cast<int>(v_px) / kCell_px * columnsOf(width_) +
                                  static_cast<int>(u_px) / kCell_px);
}

void StartRecord::beginFrame(int width, int height) {
  if (width != width_ || height != height_) {
    width_ = width, height_ = height;
    cells_.assign(static_cast<std::size_t>(columnsOf(width) * (height / kCell_px + 1)), {});
  }
  for (Cell& cell : cells_) cell.started *= kMemory, cell.followed *= kMemory;
}

void StartRecord::add(float u_px, float v_px, bool followed) {
  Cell& cell = cells_[cellAt(u_px, v_px)];
  cell.started += 1;
  if (followed) cell.followed += 1;
}

bool StartRecord::isWorthTrying(float u_px, float v_px) const {
  if (cells_.empty()) return true;
  const Cell& cell = cells_[cellAt(u_px, v_px)];
  return cell.followed + 1 >= kMinShare * (cell.started + 2);
}

}  // namespace motorcade
