#include "apps/tasks/planner.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "apps/pipeline/configuration.hpp"
#include "apps/run/run_command.hpp"
#include "apps/tasks/fingerprint.hpp"
#include "apps/tasks/planned_drive.hpp"
#include "core/edit_distance.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Options of a run of the entry's drive with a set of parameters.
RunOptions runOptionsOf(const Manifest& manifest, const PlannedDrive& drive, const ParameterSet& set, int threads) {
  const ManifestEntry& entry = *drive.entry;
  RunOptions run;
  run.rate = optionOf(entry, "rate");
  run.live = optionOf(entry, "live") == "true";
  run.masks = optionOf(entry, "masks") == "true";
  run.threads = threads;
  run.frames = drive.frame_range;
  run.config = fileOption(entry, "config", manifest.file.parent_path());
  run.given = {.camera = optionOf(entry, "camera"),
               .calibration = calibrationOption(entry, manifest.root),
               .bayer = optionOf(entry, "bayer")};
  run.assignments = set.assignments;
  run.require = optionOf(entry, "require");
  run.inject = optionOf(entry, "inject");
  return run;
}

std::vector<std::string> wordsOf(const RunOptions& run, const std::string& fps, std::optional<std::uint32_t> seed) {
  std::vector<std::string> words{"--threads", std::to_string(run.threads.value_or(1))};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--rate", run.rate);
  add("--fps", fps);
  add("--frames", run.frames);
  add("--config", run.config.string());
  add("--camera", run.given.camera);
  add("--calibration", run.given.calibration);
  add("--bayer", run.given.bayer);
  for (const std::string& assignment : run.assignments) add("--set", assignment);
  add("--require", run.require);
  add("--inject", run.inject.empty() || !seed ? run.inject : fmt::format("{},seed={}", run.inject, *seed));
  if (run.live) words.emplace_back("--live");
  if (run.masks) words.emplace_back("--masks");
  return words;
}

/// An empty list selects everything.
bool selects(const std::vector<std::string>& list, const std::string& name) {
  return list.empty() || std::ranges::find(list, name) != list.end();
}

void requireAmong(const std::vector<std::string>& known, const std::vector<std::string>& wanted, const char* option,
                  const Manifest& manifest) {
  for (const std::string& name : wanted) {
    if (std::ranges::find(known, name) != known.end()) continue;
    const std::string nearest = nearestName(name, known);
    throw UsageError(std::string(option) + " " + name + ": " + manifest.file.string() + " has none of this name" +
                     (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }
}

/// Continues a message with the other places where a drive is looked for.
std::string otherPlaces(const ManifestEntry& entry) {
  std::string text;
  for (const std::string& place : entry.other_paths) text += " or " + place;
  return text;
}

/// Builds a plan from the entries of one manifest, one after the other.
class Planner {
 public:
  Planner(const Manifest& manifest, const PlanOptions& options)
      : manifest_(manifest), options_(options), program_(programFingerprint(options.program)) {
    plan_ = {.manifest = manifest.file,
             .program = options.program,
             .program_stamp = fileStamp(options.program),
             .baseline_set = manifest.baseline_set};
    if (!manifest.published.empty()) plan_.published = readPublishedFigures(manifest.published, manifest.dataset);
  }

  void find(const ManifestEntry& entry) {
    for (const FoundDrive& found : findDrives(entry, manifest_.root)) {
      drives_.push_back(found.name);
      if (!selects(options_.only.drives, found.name)) continue;
      if (found.missing && entry.optional) {
        plan_.left_out.push_back({found.name, found.path.string() + otherPlaces(entry)});
        continue;
      }
      requireOneMeaning(found, entry);
      found_.push_back({.entry = &entry, .found = found});
    }
  }

  /// Call it after the last `find`.
  Plan plan() {
    requireSelected();
    requireSomething();
    openDrives(manifest_, found_);
    for (const PlannedDrive& drive : found_) add(drive);
    requireNames();
    return std::move(plan_);
  }

 private:
  template <class Use>
  static void forEachSeed(const ManifestEntry& entry, const Use& use) {
    if (entry.seeds.empty()) return use(std::nullopt);
    for (const std::uint32_t seed : entry.seeds) use(seed);
  }

  void add(const PlannedDrive& drive) {
    const ManifestEntry& entry = *drive.entry;
    forEachSeed(entry, [&](std::optional<std::uint32_t> seed) {
      if (entry.scene.empty())
        addTasks(drive, seed, {});
      else
        addScene(drive, seed.value_or(1));
    });
  }

  void requireOneMeaning(const FoundDrive& found, const ManifestEntry& entry) {
    const std::string source = entry.scene.empty() ? found.path.string() : fmt::format("scene {}", entry.scene);
    const auto [known, added] = sources_.emplace(found.name, source);
    if (!added && known->second != source)
      throw UsageError(entry.where + ": '" + found.name + "' is the name of " + known->second + " and of " + source +
                       "; give one of them another 'name'");
  }

  void addScene(PlannedDrive drive, std::uint32_t seed) {
    const ManifestEntry& entry = *drive.entry;
    std::string folder = fmt::format("{}-{}", entry.scene, seed);
    std::vector<std::string> words{"--scene", entry.scene, "--seed", std::to_string(seed)};
    if (entry.length > 0) {
      folder += fmt::format("-{}frames", entry.length);
      words.insert(words.end(), {"--frames", std::to_string(entry.length)});
    }
    if (!entry.size.empty()) {
      folder += fmt::format("-{}", entry.size);
      words.insert(words.end(), {"--size", entry.size});
    }
    if (!entry.calibration_errors.empty()) {
      folder += fmt::format("-calibration{}", entry.calibration_errors);
      words.insert(words.end(), {"--calibration-errors", entry.calibration_errors});
    }
    if (!entry.shake.empty()) {
      folder += fmt::format("-shake{}", entry.shake);
      words.insert(words.end(), {"--shake", entry.shake});
    }
    describeScene(drive, seed);
    drive.found.path = options_.sequences / folder;
    addTasks(drive, seed, words);
  }

  void addTasks(const PlannedDrive& drive, std::optional<std::uint32_t> seed,
                const std::vector<std::string>& render_arguments) {
    const ManifestEntry& entry = *drive.entry;
    for (const ParameterSet& set : manifest_.sets) {
      if (!selects(entry.sets, set.name) || !selects(options_.only.sets, set.name)) continue;
      Task task{.drive = drive.found.name,
                .set = set.name,
                .seed = seed,
                .sequence = drive.found.path,
                .render_arguments = render_arguments,
                .frames = drive.frames,
                .has_truth = drive.has_truth,
                .threads = options_.threads,
                .problem = drive.found.problem};
      describeRun(task, drive, set);
      addRepetitions(task, entry.repetitions, drive.fingerprint);
    }
  }

  /// Sets the command lines of the task, after a check of their options.
  void describeRun(Task& task, const PlannedDrive& drive, const ParameterSet& set) const {
    const ManifestEntry& entry = *drive.entry;
    const RunOptions run = runOptionsOf(manifest_, drive, set, options_.threads);
    task.run_arguments = wordsOf(run, optionOf(entry, "fps"), task.seed);
    const fs::path baseline = fileOption(entry, "baseline", manifest_.root);
    if (!baseline.empty()) task.evaluate_arguments = {"--baseline", baseline.string()};
    Fingerprint fingerprint;
    if (!baseline.empty()) fingerprint.addFile(baseline);
    try {
      fingerprint.add(toToml(configurationOf(run)));
    } catch (const UserError& error) {
      if (task.problem.empty()) task.problem = "set " + set.name + ": " + error.what();
    }
    task.fingerprint = fingerprint.text();
  }

  void addRepetitions(Task task, int repetitions, const std::string& sequence) {
    Fingerprint fingerprint;
    for (const std::string& part : {program_, sequence, task.fingerprint, task.problem}) fingerprint.add(part);
    for (const auto* words : {&task.render_arguments, &task.run_arguments, &task.evaluate_arguments})
      for (const std::string& word : *words) fingerprint.add(word);
    task.fingerprint = fingerprint.text();
    const std::string seed = task.seed ? fmt::format("-{}", *task.seed) : "";
    const std::string name = fmt::format("{}{}.{}", task.drive, seed, task.set);
    for (task.repetition = 1; task.repetition <= repetitions; ++task.repetition) {
      task.name = repetitions > 1 ? fmt::format("{}.{}", name, task.repetition) : name;
      plan_.tasks.push_back(task);
    }
  }

  /// Throws unless there is a drive: a batch whose drives may be missing needs at least one.
  void requireSomething() const {
    constexpr std::size_t kMostNamed = 5;
    if (!found_.empty() || plan_.left_out.empty()) return;
    std::string looked_for;
    for (std::size_t i = 0; i < std::min(kMostNamed, plan_.left_out.size()); ++i)
      looked_for += "\n  " + plan_.left_out[i].name + ": " + plan_.left_out[i].looked_for;
    if (plan_.left_out.size() > kMostNamed)
      looked_for += fmt::format("\n  and {} more", plan_.left_out.size() - kMostNamed);
    throw InputError(fmt::format("{}: none of its {} drives is on the disk; give --root FOLDER. Looked for{}",
                                 manifest_.file.string(), plan_.left_out.size(), looked_for));
  }

  void requireSelected() const {
    std::vector<std::string> sets;
    for (const ParameterSet& set : manifest_.sets) sets.push_back(set.name);
    requireAmong(drives_, options_.only.drives, "--drives", manifest_);
    requireAmong(sets, options_.only.sets, "--sets", manifest_);
  }

  void requireNames() const {
    std::map<std::string, int> count;
    for (const Task& task : plan_.tasks)
      if (++count[task.name] == 2)
        throw UsageError(manifest_.file.string() + ": there are two tasks " + task.name +
                         ", of the same drive, seed and set; write 'repetitions', or another 'name' or set");
  }

  const Manifest& manifest_;
  const PlanOptions& options_;
  std::string program_;
  Plan plan_;
  std::vector<PlannedDrive> found_;
  std::vector<std::string> drives_;             // names of all, also of those that are not selected
  std::map<std::string, std::string> sources_;  // of the drives by their names
};

}  // namespace

Plan planOf(Manifest manifest, const PlanOptions& options) {
  if (!options.only.seeds.empty()) {
    const auto seeds = seedsIn({options.only.seeds}, fmt::format("--seeds {}", options.only.seeds));
    for (ManifestEntry& entry : manifest.entries)
      if (!entry.scene.empty()) entry.seeds = seeds;
  }
  Planner planner(manifest, options);
  for (const ManifestEntry& entry : manifest.entries) planner.find(entry);
  return planner.plan();
}

}  // namespace motorcade
