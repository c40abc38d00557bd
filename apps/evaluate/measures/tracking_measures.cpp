#include "apps/evaluate/measures/tracking_measures.hpp"

#include <map>

#include "apps/evaluate/comparison/overlap.hpp"

namespace motorcade {
namespace {

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
