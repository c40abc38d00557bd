#pragma once

#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/evaluate/measures/hota.hpp"

/// How completely, how soon and under how few names moving objects are reported.
namespace motorcade {

/// What HOTA's similarity is the intersection over union of.
enum class HotaBox {
  kImage,      // boxes in the left image
  kFootprint,  // cuboids as seen from above, each from its camera; a row without a cuboid is like no label
};

/// Of all rows, predicted ones too, and the labels that are asked for nearer than `to_m`. A row that was matched to
/// another label of something that moves at some time (farther, hidden, too small, at rest now), or that lies in an
/// area which the labels leave open, counts neither as right nor as wrong; one on what never moves is wrong.
Hota movingObjectsHota(const std::vector<ComparedFrame>& frames, HotaBox box, double to_m);

/// How soon labels are reported: frames in which they are asked for before the first reported row of theirs.
struct FirstReports {
  int labels = 0, never = 0;
  Statistics frames;  // of the labels that are reported
};

/// Of the labels that are asked for nearer than `to_m`.
FirstReports firstReports(const std::vector<ComparedFrame>& frames, double to_m);

}  // namespace motorcade
