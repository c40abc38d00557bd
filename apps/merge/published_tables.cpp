#include "apps/merge/published_tables.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "apps/console/log.hpp"

namespace motorcade {
namespace {

constexpr const char* kHere = "here";  // the head of the batch's own column
constexpr int kDigits = 4;

bool isMeasure(const std::string& name) {
  return std::ranges::find(allMeasures(), name, &Measure::name) != allMeasures().end();
}

/// The drives of a figure, as a table names them.
std::string drivesText(const PublishedFigure& figure) {
  return figure.drives.size() == 1
             ? figure.drives.front()
             : fmt::format("mean of {} to {} ({})", figure.drives.front(), figure.drives.back(), figure.drives.size());
}

std::vector<std::string> setsOf(const std::vector<ResultGroup>& groups) {
  std::vector<std::string> sets;
  for (const ResultGroup& group : groups)
    if (std::ranges::find(sets, group.set()) == sets.end()) sets.push_back(group.set());
  return sets;
}

/// The number of frames of a drive in a figure; 0 where it is not given.
int framesOf(const PublishedFigure& figure, const std::string& drive) {
  const auto place = static_cast<std::size_t>(std::ranges::find(figure.drives, drive) - figure.drives.begin());
  return place < figure.frames.size() ? figure.frames[place] : 0;
}

/// Some systems report the frames from the second on, or leave out the last.
bool hasFrames(const ResultGroup& group, int frames) {
  constexpr double kMostApart = 0.02;
  return frames == 0 || std::abs(group.mean("frames") - frames) <= kMostApart * frames;
}

/// Value of a group to compare with a figure of its drive; not a number if it has none or ran other frames.
double comparedValue(const ResultGroup& group, const PublishedFigure& figure) {
  return hasFrames(group, framesOf(figure, group.drive())) ? group.mean(figure.measure) : kNoValue;
}

/// The value of a drive and set in a batch.
double comparedValueOf(const std::vector<ResultGroup>& groups, const std::string& drive, const std::string& set,
                       const PublishedFigure& figure) {
  for (const ResultGroup& group : groups)
    if (group.drive() == drive && group.set() == set) return comparedValue(group, figure);
  return kNoValue;
}

/// True if the batch has one of the figure's drives.
bool isCompared(const std::vector<ResultGroup>& groups, const PublishedFigure& figure) {
  return std::ranges::any_of(groups, [&](const ResultGroup& group) {
    return std::ranges::find(figure.drives, group.drive()) != figure.drives.end() &&
           !std::isnan(comparedValue(group, figure));
  });
}

/// Distinct values in the order of their first occurrence.
template <class Part>
std::vector<std::string> distinct(const std::vector<PublishedFigure>& figures, const Part& part) {
  std::vector<std::string> all;
  for (const PublishedFigure& figure : figures)
    if (const std::string text = part(figure); std::ranges::find(all, text) == all.end()) all.push_back(text);
  return all;
}

std::vector<PublishedFigure> figuresOf(const std::vector<PublishedFigure>& figures, const std::string& measure) {
  std::vector<PublishedFigure> of_measure;
  std::ranges::copy_if(figures, std::back_inserter(of_measure),
                       [&](const PublishedFigure& figure) { return figure.measure == measure; });
  return of_measure;
}

/// The figure of a method for a group's drive; NaN where none can be compared.
double publishedValue(const std::vector<PublishedFigure>& figures, const std::string& method,
                      const ResultGroup& group) {
  for (const PublishedFigure& figure : figures)
    if (figure.method == method && figure.drives.size() == 1 && figure.drives.front() == group.drive())
      return std::isnan(comparedValue(group, figure)) ? kNoValue : figure.value;
  return kNoValue;
}

ResultTable besideTable(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures,
                        const std::string& measure) {
  const auto methods = distinct(figures, [](const PublishedFigure& figure) { return figure.method; });
  const bool with_sets = setsOf(groups).size() > 1;
  ResultTable table{.title = "Beside published figures: " + measure, .heads = {"drive"}};
  if (with_sets) table.heads.emplace_back("set");
  table.names = table.heads.size();
  table.heads.emplace_back(kHere);
  table.heads.insert(table.heads.end(), methods.begin(), methods.end());
  for (const ResultGroup& group : groups) {
    std::vector<std::string> row{group.drive()};
    if (with_sets) row.push_back(group.set());
    row.push_back(numberText(group.mean(measure), kDigits));
    bool any = false;
    for (const std::string& method : methods) {
      const double value = publishedValue(figures, method, group);
      any = any || !std::isnan(value);
      row.push_back(numberText(value, kDigits));
    }
    if (any) table.rows.push_back(std::move(row));
  }
  return table;
}

/// A mean over drives, here and as published.
struct MeanPair {
  std::size_t drives = 0;  // that both have
  std::size_t of = 0;      // that the published mean is of
  double here = 0, published = 0;

  /// True if all drives are there. Only then is a published mean compared.
  bool whole() const { return drives == of; }
};

/// Averages those figures of one method and measure that are each of a single drive.
MeanPair meanOfSingles(const std::vector<ResultGroup>& groups, const std::string& set,
                       const std::vector<PublishedFigure>& figures, const std::string& method) {
  MeanPair mean;
  for (const PublishedFigure& figure : figures) {
    if (figure.method != method || figure.drives.size() != 1) continue;
    const double value = comparedValueOf(groups, figure.drives.front(), set, figure);
    if (std::isnan(value)) continue;
    ++mean.drives;
    mean.here += value;
    mean.published += figure.value;
  }
  mean.of = mean.drives;
  mean.here /= static_cast<double>(std::max<std::size_t>(1, mean.drives));
  mean.published /= static_cast<double>(std::max<std::size_t>(1, mean.drives));
  return mean;
}

/// Weight of a drive in a mean: the benchmark's figures are means over the segments of all drives.
double weightOf(const std::vector<ResultGroup>& groups, const std::string& drive, const std::string& set,
                const std::string& measure) {
  if (!measure.starts_with("camera_kitti_")) return 1;
  const double segments = comparedValueOf(groups, drive, set, {.measure = "camera_kitti_segments"});
  return std::isnan(segments) ? 1 : segments;
}

MeanPair meanOfDrives(const std::vector<ResultGroup>& groups, const std::string& set, const PublishedFigure& figure) {
  MeanPair mean{.of = figure.drives.size(), .published = figure.value};
  double weights = 0;
  for (const std::string& drive : figure.drives) {
    const double value = comparedValueOf(groups, drive, set, figure);
    if (std::isnan(value)) continue;
    const double weight = weightOf(groups, drive, set, figure.measure);
    ++mean.drives;
    mean.here += weight * value;
    weights += weight;
  }
  if (weights > 0) mean.here /= weights;
  return mean;
}

/// Rows of the means, of one set.
class MeanRows {
 public:
  MeanRows(ResultTable& table, const std::vector<ResultGroup>& groups, std::string set, bool with_sets)
      : table_(table), groups_(groups), set_(std::move(set)), with_sets_(with_sets) {}

  void add(const std::vector<PublishedFigure>& figures, const std::string& measure) {
    for (const std::string& method : distinct(figures, [](const PublishedFigure& f) { return f.method; })) {
      if (const MeanPair singles = meanOfSingles(groups_, set_, figures, method); singles.drives > 1)
        addRow(measure, method, singles);
      for (const PublishedFigure& figure : figures)
        if (figure.method == method && figure.drives.size() > 1)
          if (const MeanPair mean = meanOfDrives(groups_, set_, figure); mean.drives > 0) addRow(measure, method, mean);
    }
  }

 private:
  void addRow(const std::string& measure, const std::string& method, const MeanPair& mean) {
    std::vector<std::string> row{measure, method};
    if (with_sets_) row.push_back(set_);
    row.push_back(mean.whole() ? std::to_string(mean.drives) : fmt::format("{} of {}", mean.drives, mean.of));
    row.push_back(mean.whole() ? numberText(mean.here, kDigits) : "-");
    row.push_back(numberText(mean.published, kDigits));
    table_.rows.push_back(std::move(row));
  }

  ResultTable& table_;
  const std::vector<ResultGroup>& groups_;
  std::string set_;
  bool with_sets_;
};

std::vector<std::string> measuresIn(const std::vector<PublishedFigure>& figures) {
  return distinct(figures, [](const PublishedFigure& figure) { return figure.measure; });
}

}  // namespace

std::vector<PublishedFigure> comparableFigures(const std::vector<PublishedFigure>& figures) {
  std::vector<PublishedFigure> known;
  std::set<std::string> unknown;
  for (const PublishedFigure& figure : figures)
    if (isMeasure(figure.measure))
      known.push_back(figure);
    else if (unknown.insert(figure.measure).second)
      logWarning(fmt::format("published figures of '{}' are left out: no column of results.csv has this name",
                             figure.measure));
  return known;
}

std::vector<ResultTable> publishedTables(const std::vector<ResultGroup>& groups,
                                         const std::vector<PublishedFigure>& figures) {
  std::vector<ResultTable> tables;
  for (const std::string& measure : measuresIn(figures)) {
    ResultTable table = besideTable(groups, figuresOf(figures, measure), measure);
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

ResultTable publishedMeans(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures) {
  const auto sets = setsOf(groups);
  const bool with_sets = sets.size() > 1;
  ResultTable table{.title = "Means beside published ones", .heads = {"measure", "method"}};
  if (with_sets) table.heads.emplace_back("set");
  table.names = table.heads.size();
  for (const char* const head : {"drives", kHere, "published"}) table.heads.emplace_back(head);
  for (const std::string& measure : measuresIn(figures))
    for (const std::string& set : sets)
      MeanRows(table, groups, set, with_sets).add(figuresOf(figures, measure), measure);
  return table;
}

ResultTable publishedSources(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures) {
  ResultTable table{
      .title = "Sources of the published figures", .heads = {"method", "measures", "source", "note"}, .names = 4};
  for (const PublishedFigure& figure : figures) {
    if (!isCompared(groups, figure)) continue;
    const auto same = std::ranges::find_if(table.rows, [&](const std::vector<std::string>& row) {
      return row[0] == figure.method && row[2] == figure.source && row[3] == figure.note;
    });
    if (same == table.rows.end())
      table.rows.push_back({figure.method, figure.measure, figure.source, figure.note});
    else if ((*same)[1].find(figure.measure) == std::string::npos)
      (*same)[1] += ", " + figure.measure;
  }
  return table;
}

ResultTable otherFrames(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures) {
  ResultTable table{.title = "Not beside published figures, as of other frames",
                    .heads = {"drive", "set", "frames here", "frames of the drive"},
                    .names = 2};
  for (const ResultGroup& group : groups)
    for (const PublishedFigure& figure : figures) {
      if (std::ranges::find(figure.drives, group.drive()) == figure.drives.end()) continue;
      const int frames = framesOf(figure, group.drive());
      if (hasFrames(group, frames)) continue;
      table.rows.push_back({group.drive(), group.set(), numberText(group.mean("frames"), 0), std::to_string(frames)});
      break;
    }
  return table;
}

std::vector<PublishedRow> publishedRows(const std::vector<PublishedFigure>& figures) {
  std::vector<PublishedRow> rows;
  for (const PublishedFigure& figure : figures) {
    const std::string drive = drivesText(figure);
    auto row = std::ranges::find_if(
        rows, [&](const PublishedRow& r) { return r.method == figure.method && r.drive == drive; });
    if (row == rows.end()) {
      rows.push_back({figure.method, drive, figure.source, MeasureValues(allMeasures().size(), kNoValue)});
      row = std::prev(rows.end());
    }
    if (row->source.find(figure.source) == std::string::npos) row->source += "; " + figure.source;
    row->values[measureIndex(figure.measure)] = figure.value;
  }
  return rows;
}

}  // namespace motorcade
