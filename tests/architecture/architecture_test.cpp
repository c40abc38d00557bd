#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Tests the arrows between the folders, apps -> {frontend, backend, io} -> core, and between the rooms of a folder.
namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

const std::map<std::string, std::set<std::string>> kMayInclude{
    {"core", {"core"}},
    {"frontend", {"core", "frontend"}},
    {"backend", {"core", "backend"}},
    {"io", {"core", "io"}},
    {"apps", {"core", "frontend", "backend", "io", "apps"}},
};

/// Rooms of a folder in the order of the flow: a room may include those before it, and itself. The empty name stands
/// for files in the folder itself. In apps the library comes first, so that evaluation and rendering never ship in a
/// vehicle.
const std::map<std::string, std::vector<std::string>> kRooms{
    {"frontend", {"", "image", "geometry", "features", "matching", "motion", "segmentation", "tracking", "shape"}},
    {"backend", {"", "graph", "elimination", "solver", "motion", "factors", "window", "pose_graph", "joint"}},
    {"io",
     {"files", "images", "rig", "sequence", "truth", "layouts", "results", "inputs", "messages", "stream", "bag", ""}},
    {"apps", {"watch",    "pipeline", "interface", "console", "canvas", "html",  "inject",   "recorded",
              "evaluate", "draw",     "latency",   "export",  "check",  "synth", "solve",    "view",
              "run",      "bridge",   "tasks",     "merge",   "report", "batch", "commands", ""}},
    {"apps/synth", {"shapes", "textures", "models", "scenes", "rendering", "output", ""}},
    {"apps/evaluate", {"comparison", "measures", "report", ""}},
    {"apps/bridge", {"messages", "dds", ""}},
};

/// Rooms that stand beside the flow, with those of their folder that they may include besides themselves.
const std::map<std::string, std::set<std::string>> kSideRooms{{"backend/filter", {"motion"}}};

/// Folders without sources.
const std::set<std::string> kNoRooms{"apps/manual", "apps/bridge/idl"};

/// Calls `visit(file, included)` for each include of a folder's sources.
void forEachInclude(const std::string& folder,
                    const std::function<void(const std::string&, const std::string&)>& visit) {
  const std::regex include(R"re(\s*#\s*include\s*["<]([^">]+)[">].*)re");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(MOTORCADE_SOURCE_DIR) / folder)) {
    if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);)
      if (std::regex_match(line, match, include))
        visit(fs::relative(entry.path(), MOTORCADE_SOURCE_DIR).string(), match[1]);
  }
}

std::vector<std::string> includesIn(const std::string& folder,
                                    const std::function<bool(const std::string&)>& forbidden) {
  std::vector<std::string> found;
  forEachInclude(folder, [&](const std::string& file, const std::string& included) {
    if (forbidden(included)) found.push_back(file + " includes " + included);
  });
  return found;
}

TEST(Architecture, IncludesFollowTheArrowsBetweenFolders) {
  for (const auto& [folder, targets] : kMayInclude) {
    const auto forbidden = includesIn(folder, [&allowed = targets](const std::string& included) {
      const std::string target = included.substr(0, included.find('/'));
      return kMayInclude.contains(target) && !allowed.contains(target);
    });
    EXPECT_THAT(forbidden, IsEmpty());
  }
}

/// The room of a path in a folder: `image` of `frontend/image/image_pyramid.hpp`, empty for what lies in the folder
/// itself.
std::string roomOf(const std::string& folder, const std::string& path) {
  const auto begin = folder.size() + 1, end = path.find('/', begin);
  return end == std::string::npos ? "" : path.substr(begin, end - begin);
}

/// The rooms that a room may include, itself among them.
std::set<std::string> roomsBelow(const std::string& folder, const std::string& room) {
  const auto side = kSideRooms.find(folder + "/" + room);
  std::set<std::string> allowed{room};
  if (side != kSideRooms.end()) {
    allowed.insert(side->second.begin(), side->second.end());
    allowed.insert("");
    return allowed;
  }
  for (const std::string& below : kRooms.at(folder)) {
    if (below == room) break;
    allowed.insert(below);
  }
  return allowed;
}

TEST(Architecture, IncludesFollowTheArrowsBetweenRooms) {
  for (const auto& [name, rooms] : kRooms) {
    std::vector<std::string> against;
    forEachInclude(name, [&, &folder = name](const std::string& file, const std::string& included) {
      if (included.starts_with(folder + "/") &&
          !roomsBelow(folder, roomOf(folder, file)).contains(roomOf(folder, included)))
        // NOLINTNEXTLINE(performance-inefficient-string-concatenation): in a test
        against.push_back(file + " includes " + included);
    });
    EXPECT_THAT(against, IsEmpty());
  }
}

TEST(Architecture, EveryFolderInsideAFolderIsARoom) {
  for (const auto& [folder, rooms] : kRooms) {
    for (const auto& entry : fs::directory_iterator(fs::path(MOTORCADE_SOURCE_DIR) / folder)) {
      const std::string room = entry.path().filename().string();
      if (!entry.is_directory()) continue;
      // NOLINTNEXTLINE(performance-inefficient-string-concatenation): in a test
      const std::string path = folder + "/" + room;
      EXPECT_TRUE(kSideRooms.contains(path) || kNoRooms.contains(path) || std::ranges::find(rooms, room) != rooms.end())
          << path;
    }
  }
}

/// A file may include only what does not include it, over however many steps.
TEST(Architecture, NoIncludesGoInACircle) {
  std::map<std::string, std::set<std::string>> includes;
  for (const auto& [folder, allowed] : kMayInclude)
    forEachInclude(folder,
                   [&](const std::string& file, const std::string& included) { includes[file].insert(included); });
  std::set<std::string> done, open;
  const std::function<void(const std::string&)> visit = [&](const std::string& file) {
    if (done.contains(file)) return;
    ASSERT_TRUE(open.insert(file).second) << file << " includes itself over other files";
    for (const std::string& included : includes[file]) visit(included);
    open.erase(file);
    done.insert(file);
  };
  for (const auto& [file, included] : std::map(includes)) visit(file);
}

TEST(Architecture, TestsMirrorTheRooms) {
  const fs::path root = MOTORCADE_SOURCE_DIR;
  for (const auto& [folder, rooms] : kRooms) {
    if (folder.find('/') != std::string::npos) continue;  // their tests lie beside each other
    for (const auto& entry : fs::recursive_directory_iterator(root / "tests" / folder)) {
      const std::string name = entry.path().filename().string();
      if (!name.ends_with("_test.cpp")) continue;
      const fs::path room = fs::relative(entry.path().parent_path(), root / "tests");
      EXPECT_TRUE(fs::is_directory(root / room) && room != folder) << entry.path() << " lies in no room";
    }
  }
}

TEST(Architecture, StagesKnowNeitherFlowGraphNorLog) {
  for (const char* folder : {"core", "frontend", "backend", "io"}) {
    EXPECT_THAT(includesIn(folder,
                           [](const std::string& included) {
                             return included == "oneapi/tbb/flow_graph.h" || included.starts_with("spdlog/") ||
                                    included.starts_with("CLI/");
                           }),
                IsEmpty());
  }
}

/// The shared library is linked to neither. The first and the third file are of programs, the others of modules.
TEST(Architecture, OpenCvAndYamlCppStayInModulesAndPrograms) {
  std::set<std::string> files;
  for (const auto& [folder, allowed] : kMayInclude)
    forEachInclude(folder, [&](const std::string& file, const std::string& included) {
      if (included.starts_with("opencv2/") || included.starts_with("yaml-cpp/")) files.insert(file);
    });
  EXPECT_THAT(files, testing::ElementsAre("apps/console/own_program.cpp", "frontend/features/sift_module.cpp",
                                          "io/results/outline_polygons.cpp", "io/rig/yaml_module.cpp"));
}

TEST(Architecture, TheFlowGraphIsWiredInOneFile) {
  std::set<std::string> files;
  forEachInclude("apps", [&](const std::string& file, const std::string& included) {
    if (included.starts_with("oneapi/tbb/flow_graph")) files.insert(file);
  });
  // The team waits for graphs, and wires none.
  EXPECT_THAT(files, testing::ElementsAre("apps/pipeline/flow_graph.cpp", "apps/pipeline/worker_team.hpp"));
}

TEST(Architecture, TheLibraryTouchesNoProcessWideState) {
  const std::regex process_wide(
      R"re(\b(global_control|setNumThreads|sigaction|std::signal|theRNG|set_default_logger)\b)re");
  for (const char* folder : {"core", "frontend", "backend", "io", "apps/pipeline"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(MOTORCADE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);)
        EXPECT_FALSE(std::regex_search(line, process_wide)) << entry.path() << ": " << line;
    }
  }
}

}  // namespace
}  // namespace motorcade
