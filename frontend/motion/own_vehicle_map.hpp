#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Map of the left image's cells that show the own vehicle. Points fixed to the camera vote for their cells; points at
/// rest in the world, seen through a cell, vote against it. Cells that hang together with a border of the image are
/// masked, with a margin, and filled up to that border.
class OwnVehicleMap {
 public:
  static constexpr int kCell_px = 16;  // three times the least distance of points, half that of usual ones

  explicit OwnVehicleMap(const StereoCamera& camera);

  void voteFor(double u_px, double v_px) { vote(u_px, v_px, kFor); }
  void voteAgainst(double u_px, double v_px) { vote(u_px, v_px, kAgainst); }
  /// Counts the votes since the last time. A cell has one vote, and votes against it prevail.
  void count();
  /// Forgets the votes.
  void discard();

  /// True where the own vehicle is seen.
  bool isMasked(double u_px, double v_px) const { return view_ && masked_[cellAt(u_px, v_px)] != 0; }
  /// True where cells around had votes for them.
  bool isNearVotes(double u_px, double v_px) const { return any_votes_ && near_votes_[cellAt(u_px, v_px)] != 0; }
  bool empty() const { return !view_; }
  const std::optional<OwnVehicleView>& view() const { return view_; }

 private:
  enum Ballot : std::uint8_t { kFor = 1, kAgainst = 2 };
  enum class Border { kBottom, kLeft, kRight, kTop };
  struct Cell {
    int column, row;
  };
  using Cells = std::vector<std::uint8_t>;  // row by row

  int cellAt(double u_px, double v_px) const;
  void vote(double u_px, double v_px, Ballot ballot);
  bool has(const Cells& cells, int column, int row) const;
  template <class Act>
  void forEachAround(Cell cell, int reach, const Act& act) const;
  void mask();
  std::vector<Cell> takeConnected(Cells& sure, Cell first) const;
  std::optional<Border> borderOf(const std::vector<Cell>& part) const;
  void fill(Cell cell, Border border);
  OwnVehicleView describe() const;

  StereoCamera camera_;
  int columns_, rows_;
  Cells ballot_;
  bool voted_ = false, any_votes_ = false;  // since the last count; for any cell, ever
  std::vector<int> score_;
  Cells sure_;  // the own vehicle was seen there often enough
  Cells masked_, near_votes_;
  std::optional<OwnVehicleView> view_;
};

}  // namespace motorcade
