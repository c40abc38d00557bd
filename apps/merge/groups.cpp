#include "apps/merge/groups.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace motorcade {

void ResultGroup::add(const MergedTask& task) {
  has_labels_ = has_labels_ || task.has_labels;
  worst_.add(task.worst);
  auto seed = std::ranges::find(seeds_, task.task.seed, &Seed::seed);
  if (seed == seeds_.end()) {
    seeds_.push_back({task.task.seed, MeasureValues(allMeasures().size(), 0)});
    counts_.emplace_back(allMeasures().size(), 0);
    seed = std::prev(seeds_.end());
  }
  auto& counts = counts_[static_cast<std::size_t>(seed - seeds_.begin())];
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (std::isnan(task.values[i])) continue;
    seed->values[i] += task.values[i];
    ++counts[i];
  }
}

void ResultGroup::finish() {
  for (std::size_t seed = 0; seed < seeds_.size(); ++seed)
    for (std::size_t i = 0; i < counts_[seed].size(); ++i) {
      double& value = seeds_[seed].values[i];
      value = counts_[seed][i] > 0 ? value / static_cast<double>(counts_[seed][i]) : kNoValue;
    }
}

std::vector<double> ResultGroup::valuesOf(std::string_view measure) const {
  const std::size_t index = measureIndex(measure);
  std::vector<double> values;
  for (const Seed& seed : seeds_)
    if (!std::isnan(seed.values[index])) values.push_back(seed.values[index]);
  return values;
}

double ResultGroup::mean(std::string_view measure) const {
  const auto n = static_cast<double>(count(measure));
  return n > 0 ? sum(measure) / n : kNoValue;
}

double ResultGroup::sum(std::string_view measure) const {
  const auto values = valuesOf(measure);
  return values.empty() ? kNoValue : std::accumulate(values.begin(), values.end(), 0.0);
}

double ResultGroup::largest(std::string_view measure) const {
  const auto values = valuesOf(measure);
  return values.empty() ? kNoValue : std::ranges::max(values);
}

double ResultGroup::smallest(std::string_view measure) const {
  const auto values = valuesOf(measure);
  return values.empty() ? kNoValue : std::ranges::min(values);
}

std::size_t ResultGroup::count(std::string_view measure) const { return valuesOf(measure).size(); }

std::vector<ResultGroup> groupsOf(const MergedBatch& batch) {
  std::vector<std::string> drives;  // in the order of the batch
  std::map<std::string, std::vector<ResultGroup>> groups;
  for (const MergedTask& task : batch.tasks) {
    if (task.outcome != TaskOutcome::kDone) continue;
    auto& of_drive = groups[task.task.drive];
    if (of_drive.empty()) drives.push_back(task.task.drive);
    auto group = std::ranges::find(of_drive, task.task.set, &ResultGroup::set);
    if (group == of_drive.end()) group = of_drive.insert(of_drive.end(), ResultGroup(task.task.drive, task.task.set));
    group->add(task);
  }
  std::vector<ResultGroup> all;
  for (const std::string& drive : drives)
    for (ResultGroup& group : groups[drive]) {
      group.finish();
      all.push_back(std::move(group));
    }
  return all;
}

std::size_t setsIn(const std::vector<ResultGroup>& groups) {
  std::set<std::string> sets;
  for (const ResultGroup& group : groups) sets.insert(group.set());
  return sets.size();
}

}  // namespace motorcade
