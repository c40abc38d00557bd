#include "apps/evaluate/measures/tracking_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "apps/evaluate/comparison/overlap.hpp"
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

bool isWanted(const TrueObject& object, double to_m) { return object.asked() && object.range_m() < to_m; }

bool isJudged(const ComparedFrame& frame, const MatchedRow& row, double to_m) {
  if (row.object < 0) return !row.in_ignored_area;
  const TrueObject& object = frame.objects[row.object];
  return isWanted(object, to_m) || !object.ever_moves;
}

double similarityOf(const ComparedFrame& frame, const TrueObject& object, const ObjectEstimate& row, HotaBox box) {
  if (box == HotaBox::kImage) return intersectionOverUnion(object.truth.box, row.box);
  return row.cuboid ? footprintIou(labeledCuboid(object.truth), estimatedCuboid(frame.T_world_cam, row)) : 0;
}

HotaFrame hotaFrame(const ComparedFrame& frame, HotaBox box, double to_m) {
  std::vector<const TrueObject*> objects;
  std::vector<const ObjectEstimate*> rows;
  HotaFrame result;
  for (const TrueObject& object : frame.objects) {
    if (!isWanted(object, to_m)) continue;
    objects.push_back(&object);
    result.labels.push_back(object.truth.id);
  }
  for (const MatchedRow& row : frame.rows) {
    if (!isJudged(frame, row, to_m)) continue;
    rows.push_back(&row.row.object);
    result.tracks.push_back(row.row.object.track.value);
  }
  result.similarity.resize(std::ssize(objects), std::ssize(rows));
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (std::size_t j = 0; j < rows.size(); ++j)
      result.similarity(i, j) = similarityOf(frame, *objects[i], *rows[j], box);
  return result;
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

Hota movingObjectsHota(const std::vector<ComparedFrame>& frames, HotaBox box, double to_m) {
  std::vector<HotaFrame> of_hota;
  of_hota.reserve(frames.size());
  for (const ComparedFrame& frame : frames) of_hota.push_back(hotaFrame(frame, box, to_m));
  return hotaOf(of_hota);
}

FirstReports firstReports(const std::vector<ComparedFrame>& frames, double to_m) {
  struct Wait {
    int frames = 0;
    bool asked = false, reported = false;
  };
  std::map<std::int64_t, Wait> waits;
  for (const ComparedFrame& frame : frames) {
    for (const MatchedRow& row : frame.rows)
      if (row.object >= 0 && row.reported()) waits[frame.objects[row.object].truth.id].reported = true;
    for (const TrueObject& object : frame.objects) {
      if (!isWanted(object, to_m)) continue;
      Wait& wait = waits[object.truth.id];
      wait.asked = true;
      if (!wait.reported) ++wait.frames;
    }
  }
  FirstReports reports;
  std::vector<double> waited;
  for (const auto& [label, wait] : waits) {
    if (!wait.asked) continue;
    ++reports.labels;
    if (wait.reported)
      waited.push_back(wait.frames);
    else
      ++reports.never;
  }
  reports.frames = statisticsOf(std::move(waited));
  return reports;
}

}  // namespace motorcade
