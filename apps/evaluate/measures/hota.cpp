#include "apps/evaluate/measures/hota.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/assignment.hpp"

namespace motorcade {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Ids as consecutive numbers in the order of first occurrence, with the number of their frames.
struct Ids {
  std::map<std::int64_t, Eigen::Index> numbers;
  std::vector<double> frames;
  void add(const std::vector<std::int64_t>& ids) {
    for (const std::int64_t id : ids) {
      const auto number = numbers.try_emplace(id, std::ssize(frames)).first->second;
      if (number == std::ssize(frames)) frames.push_back(0);
      ++frames[number];
    }
  }
};

/// A label and its track in one frame, by their numbers.
struct Match {
  Eigen::Index label, track;
  double similarity;
};

/// Counts of the whole drive that every threshold needs.
struct Drive {
  Ids labels, tracks;
  double label_frames = 0, track_frames = 0;
  std::vector<Match> matches;

  /// Size of the union of the label's and the track's frames, of which `together` have both.
  double either(Eigen::Index label, Eigen::Index track, double together) const {
    return labels.frames[label] + tracks.frames[track] - together;
  }
};

/// Alignment of labels and tracks over the whole drive: the Jaccard index of their frames. A frame counts by the
/// similarity's share of all that compete for it.
Eigen::MatrixXd alignmentOf(const std::vector<HotaFrame>& frames, const Drive& drive) {
  Eigen::MatrixXd together = Eigen::MatrixXd::Zero(std::ssize(drive.labels.frames), std::ssize(drive.tracks.frames));
  for (const HotaFrame& frame : frames) {
    const Eigen::VectorXd of_label = frame.similarity.rowwise().sum(), of_track = frame.similarity.colwise().sum();
    for (Eigen::Index i = 0; i < frame.similarity.rows(); ++i) {
      for (Eigen::Index j = 0; j < frame.similarity.cols(); ++j) {
        const double all = of_label[i] + of_track[j] - frame.similarity(i, j);
        if (all > kEpsilon)
          together(drive.labels.numbers.at(frame.labels[i]), drive.tracks.numbers.at(frame.tracks[j])) +=
              frame.similarity(i, j) / all;
      }
    }
  }
  for (Eigen::Index i = 0; i < together.rows(); ++i)
    for (Eigen::Index j = 0; j < together.cols(); ++j) together(i, j) /= drive.either(i, j, together(i, j));
  return together;
}

/// Matches one to one, with the largest sum of similarity times alignment.
void matchFrame(const HotaFrame& frame, const Eigen::MatrixXd& alignment, Drive& drive) {
  std::vector<Eigen::Index> labels, tracks;
  for (const auto id : frame.labels) labels.push_back(drive.labels.numbers.at(id));
  for (const auto id : frame.tracks) tracks.push_back(drive.tracks.numbers.at(id));
  const Eigen::MatrixXd cost = -(alignment(labels, tracks).array() * frame.similarity.array()).matrix();
  const auto columns = assignMinCost(cost, 0);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (const int j = columns[i]; j >= 0)
      drive.matches.push_back({labels[i], tracks[j], frame.similarity(static_cast<Eigen::Index>(i), j)});
}

Drive matchedDrive(const std::vector<HotaFrame>& frames) {
  Drive drive;
  for (const HotaFrame& frame : frames) {
    drive.labels.add(frame.labels);
    drive.tracks.add(frame.tracks);
    drive.label_frames += static_cast<double>(frame.labels.size());
    drive.track_frames += static_cast<double>(frame.tracks.size());
  }
  const Eigen::MatrixXd alignment = alignmentOf(frames, drive);
  for (const HotaFrame& frame : frames)
    if (frame.similarity.size() > 0) matchFrame(frame, alignment, drive);
  return drive;
}

/// Adds the measures of the matches that have at least the threshold's similarity, times `weight`.
void addThreshold(const Drive& drive, double threshold, double weight, Hota& hota) {
  std::map<std::pair<Eigen::Index, Eigen::Index>, double> together;
  double matches = 0, similarity = 0, ass_a = 0, ass_re = 0, ass_pr = 0;
  for (const Match& match : drive.matches) {
    if (match.similarity < threshold - kEpsilon) continue;
    ++together[{match.label, match.track}];
    ++matches;
    similarity += match.similarity;
  }
  for (const auto& [ids, n] : together) {
    ass_a += n * n / drive.either(ids.first, ids.second, n);
    ass_re += n * n / drive.labels.frames[ids.first];
    ass_pr += n * n / drive.tracks.frames[ids.second];
  }
  const double any = std::max(1.0, matches),
               det_a = matches / std::max(1.0, drive.label_frames + drive.track_frames - matches);
  hota.det_a += weight * det_a;
  hota.det_re += weight * matches / std::max(1.0, drive.label_frames);
  hota.det_pr += weight * matches / std::max(1.0, drive.track_frames);
  hota.ass_a += weight * ass_a / any;
  hota.ass_re += weight * ass_re / any;
  hota.ass_pr += weight * ass_pr / any;
  hota.loc_a += weight * (matches > 0 ? similarity / matches : 1);
  hota.hota += weight * std::sqrt(det_a * ass_a / any);
}

}  // namespace

Hota hotaOf(const std::vector<HotaFrame>& frames) {
  constexpr int kThresholds = 19;
  constexpr double kStep = 0.05;
  const Drive drive = matchedDrive(frames);
  Hota hota;
  hota.labels = static_cast<int>(drive.label_frames);
  hota.rows = static_cast<int>(drive.track_frames);
  for (int i = 1; i <= kThresholds; ++i) addThreshold(drive, kStep * i, 1.0 / kThresholds, hota);
  return hota;
}

}  // namespace motorcade
