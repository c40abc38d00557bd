#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace motorcade {

/// A set of parameters by which every drive is run.
struct ParameterSet {
  std::string name{};
  std::vector<std::string> assignments{};  // key=value, as `run --set` takes them
};

/// A line of a manifest: a drive, a glob of several, or a scene to render, with the options for its runs.
struct ManifestEntry {
  std::string path{};                         // of a recorded drive, or a glob of several
  std::vector<std::string> other_paths{};     // where to look, in this order, when nothing is there
  bool optional = false;                      // a drive that is not on the disk is left out
  std::string scene{};                        // of a rendered one, in its place
  std::string name{};                         // of the drive; from its path or scene when empty
  int length = 0;                             // frames to render; the scene's own when 0
  std::string size{};                         // of rendered images, WIDTHxHEIGHT
  std::string calibration_errors{}, shake{};  // of the rendered rig, as `synth` takes them
  std::vector<std::string> sets{};            // names of parameter sets; all of them when empty
  std::vector<std::uint32_t> seeds{};
  int repetitions = 1;
  std::map<std::string, std::string> options{};  // of `run` by their names, and `baseline`, of `evaluate`
  std::string where{};                           // file and line, for messages
};

/// Many drives and the options for their runs, as in the manifest's file. The drives are not looked for yet. Formats:
/// docs/formats.md.
struct Manifest {
  std::filesystem::path file{};  // absolute
  std::filesystem::path root{};  // absolute: what paths of drives and baselines are relative to
  std::string baseline_set{};
  std::string dataset{};              // whose published figures count; empty for none
  std::filesystem::path published{};  // absolute: the file with these figures; empty for none
  std::vector<ParameterSet> sets{};   // in the order of the file; at least one
  std::vector<ManifestEntry> entries{};
};

/// Reads TOML or, if the name ends with .csv, .tsv or .txt, a table or a list of paths. A given `root` takes precedence
/// over the manifest's own. Throws UsageError naming file, line, key and how to fix it.
Manifest readManifest(const std::filesystem::path& file, const std::filesystem::path& root = {});

/// Expands a path as a shell does: ~ at its beginning is the home folder, $NAME and ${NAME} are variables of the
/// environment. Variables that are not set stay as they are.
std::string expandedPath(const std::string& text);

/// Fields that both forms of a manifest share: keys with one or several words.
struct ManifestFields {
  std::map<std::string, std::vector<std::string>> words{};
  std::string where{};  // file and line, for messages
};

/// One entry, or one for each value of `each`, which replaces {} in the other keys. Throws UsageError naming the place,
/// the key and how to fix it.
std::vector<ManifestEntry> manifestEntries(const ManifestFields& fields);

/// The key of a table's column by its head, in any case. For `path` it may also be drive, sequence, folder and the
/// like. Empty for other heads.
std::string columnKey(const std::string& head);

/// Numbers and ranges of them, as 1-5, in ascending order. Throws UsageError.
std::vector<std::uint32_t> seedsIn(const std::vector<std::string>& words, const std::string& where);

/// Checks the name of a drive or a set, which becomes the name of a folder. Throws UsageError.
void requireName(const std::string& name, const std::string& where);

Manifest readManifestToml(const std::filesystem::path& file, const std::string& text);
Manifest readManifestCsv(const std::filesystem::path& file, const std::string& text);

}  // namespace motorcade
