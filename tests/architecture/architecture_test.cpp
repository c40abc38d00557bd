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

/// Holds the arrows between the folders: apps -> {frontend, backend, io} -> core.
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

/// Calls `visit(file, included)` for each include of a folder's sources.
void forEachInclude(const std::string& folder, const std::function<void(const std::string&, const std::string&)>& visit) {
  const std::regex include(R"re(\s*#\s*include\s*["<]([^">]+)[">].*)re");
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(MOTORCADE_SOURCE_DIR) / folder)) {
    if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);)
      if (std::regex_match(line, match, include)) visit(fs::relative(entry.path(), MOTORCADE_SOURCE_DIR).string(), match[1]);
  }
}

std::vector<std::string> includesIn(const std::string& folder, const std::function<bool(const std::string&)>& forbidden) {
  std::vector<std::string> found;
  forEachInclude(folder, [&](const std::string& file, const std::string& included) {
    if (forbidden(included)) found.push_back(file + " includes " + included);
  });
  return found;
}

TEST(Architecture, IncludesFollowTheArrowsBetweenFolders) {
  for (const auto& [folder, allowed] : kMayInclude) {
    const auto forbidden = includesIn(folder, [&allowed = allowed](const std::string& included) {
      const std::string target = included.substr(0, included.find('/'));
      return kMayInclude.contains(target) && !allowed.contains(target);
    });
    EXPECT_THAT(forbidden, IsEmpty());
  }
}

TEST(Architecture, StagesKnowNeitherFlowGraphNorLog) {
  for (const char* folder : {"core", "frontend", "backend", "io"}) {
    EXPECT_THAT(includesIn(folder,
                           [](const std::string& included) {
                             return included.find("flow_graph") != std::string::npos || included.starts_with("spdlog/") ||
                                    included.starts_with("CLI/");
                           }),
                IsEmpty());
  }
}

TEST(Architecture, OpenCvStaysInsideFrontendAndIo) {
  for (const char* folder : {"core", "backend", "apps/pipeline", "apps/run"})
    EXPECT_THAT(includesIn(folder, [](const std::string& included) { return included.starts_with("opencv2/"); }), IsEmpty());
}

TEST(Architecture, TheFlowGraphIsWiredInOneFile) {
  std::set<std::string> files;
  forEachInclude("apps", [&](const std::string& file, const std::string& included) {
    if (included.find("flow_graph") != std::string::npos) files.insert(file);
  });
  EXPECT_THAT(files, testing::ElementsAre("apps/pipeline/pipeline.cpp"));
}

TEST(Architecture, TheLibraryTouchesNoProcessWideState) {
  const std::regex process_wide(R"re(\b(global_control|setNumThreads|sigaction|std::signal|theRNG|set_default_logger)\b)re");
  for (const char* folder : {"core", "frontend", "backend", "io", "apps/pipeline"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(MOTORCADE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) EXPECT_FALSE(std::regex_search(line, process_wide)) << entry.path() << ": " << line;
    }
  }
}

}  // namespace
}  // namespace motorcade
