#pragma once

#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/evaluate/measures/hota.hpp"

/// Measures of how completely, how soon and under how few ids moving objects are reported.
namespace motorcade {

/// Shapes whose intersection over union is HOTA's similarity.
enum class HotaBox {
  kImage,      // boxes in the left image
  kFootprint,  // cuboids as seen from above, each from its camera; a row without a cuboid is like no label
};

/// HOTA of all rows, predicted ones too, and the labels that are asked for nearer than `to_m`. A row in an area that
/// the labels leave open counts neither as right nor as wrong. Nor does a row on another label that moves at some time
/// (farther, hidden, too small, at rest now). A row on something that never moves is wrong.
Hota movingObjectsHota(const std::vector<ComparedFrame>& frames, HotaBox box, double to_m);

/// Delay of first reports: frames in which a label is asked for before its first reported row.
struct FirstReports {
  int labels = 0, never = 0;
  Statistics frames;  // of the labels that are reported
};

/// First reports of the labels that are asked for nearer than `to_m`.
FirstReports firstReports(const std::vector<ComparedFrame>& frames, double to_m);

}  // namespace motorcade
