#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

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

}  // namespace motorcade
