#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

/// Measures of how completely, how soon and under how few ids moving objects are reported.
namespace motorcade {

/// One frame of labels and of a tracker's reports, each id at most once.
struct HotaFrame {
  std::vector<std::int64_t> labels, tracks;
  Eigen::MatrixXd similarity;  // in [0, 1], a row per label, a column per track
};

/// HOTA and its parts, each the mean over the similarity thresholds 0.05, 0.1, ... 0.95 of a match (Luiten et al.,
/// HOTA: a higher order metric for evaluating multi-object tracking, 2021).
struct Hota {
  int labels = 0, rows = 0;  // over all frames
  double hota = 0;
  double det_a = 0, det_re = 0, det_pr = 0;  // detection: accuracy, recall, precision
  double ass_a = 0, ass_re = 0, ass_pr = 0;  // the same of association
  double loc_a = 0;                          // mean similarity of matches; 1 at a threshold without any
};

Hota hotaOf(const std::vector<HotaFrame>& frames);

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
