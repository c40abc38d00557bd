#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/merge/merged_batch.hpp"

namespace motorcade {

/// The results of one drive with one set of parameters. Repetitions of one seed are averaged first, so that each seed
/// counts once.
class ResultGroup {
 public:
  struct Seed {
    std::optional<std::uint32_t> seed{};
    MeasureValues values{};
  };

  ResultGroup(std::string drive, std::string set) : drive_(std::move(drive)), set_(std::move(set)) {}
  void add(const MergedTask& task);
  /// Computes the means; call it after the last `add`.
  void finish();

  const std::string& drive() const { return drive_; }
  const std::string& set() const { return set_; }
  bool hasLabels() const { return has_labels_; }
  const WorstFrameOfEach& worst() const { return worst_; }
  const std::vector<Seed>& seeds() const { return seeds_; }

  /// Statistics over the seeds that have a value; kNoValue where none has.
  double mean(std::string_view measure) const;
  double sum(std::string_view measure) const;
  double largest(std::string_view measure) const;
  double smallest(std::string_view measure) const;
  std::size_t count(std::string_view measure) const;

 private:
  std::vector<double> valuesOf(std::string_view measure) const;

  std::string drive_, set_;
  bool has_labels_ = false;
  WorstFrameOfEach worst_;
  std::vector<Seed> seeds_;
  std::vector<std::vector<std::size_t>> counts_;  // of the repetitions that have a value, by seed and measure
};

/// The groups of a batch that have results, in its order: all sets of a drive one after the other.
std::vector<ResultGroup> groupsOf(const MergedBatch& batch);

/// Counts the parameter sets.
std::size_t setsIn(const std::vector<ResultGroup>& groups);

}  // namespace motorcade
