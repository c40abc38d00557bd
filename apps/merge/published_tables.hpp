#pragma once

#include <string>
#include <vector>

#include "apps/merge/groups.hpp"
#include "apps/merge/result_tables.hpp"
#include "apps/tasks/plan.hpp"

/// Published figures beside those of a batch. Only measures of the same definition are compared.
namespace motorcade {

/// Leaves out figures of measures that no result has, and logs a warning for each such measure.
std::vector<PublishedFigure> comparableFigures(const std::vector<PublishedFigure>& figures);

/// A table for each measure, with a row for each drive and set that both have and a column for each method.
std::vector<ResultTable> publishedTables(const std::vector<ResultGroup>& groups,
                                         const std::vector<PublishedFigure>& figures);

/// Means of each measure and method over the drives that both have.
ResultTable publishedMeans(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures);

/// Lists the sources of the figures in these tables, with notes on how their measurement differs.
ResultTable publishedSources(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures);

/// Drives that are not compared, as the run's frames differ from those of the published figures.
ResultTable otherFrames(const std::vector<ResultGroup>& groups, const std::vector<PublishedFigure>& figures);

/// Rows of results.csv: one for each method and drive, with its figures in the order of the measures.
struct PublishedRow {
  std::string method{}, drive{}, source{};
  MeasureValues values{};
};
std::vector<PublishedRow> publishedRows(const std::vector<PublishedFigure>& figures);

}  // namespace motorcade
