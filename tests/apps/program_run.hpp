#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/io/temporary_folder.hpp"

/// `motorcade run` from outside, on a short rendered drive that the build's test fixture makes.
namespace motorcade::test {

namespace fs = std::filesystem;

inline const fs::path kSequence = MOTORCADE_RENDERED_SEQUENCE;
inline constexpr std::size_t kFrames = MOTORCADE_RENDERED_FRAMES;
inline const std::vector<std::string> kReproducible{"camera_online.txt", "camera_final.txt",   "camera_online.tum",
                                                    "camera_final.tum",  "objects_online.csv", "objects_final.csv"};

/// Shell command that waits at most a minute until a file has more than `lines` lines.
inline std::string waitForLines(const fs::path& file, std::size_t lines) {
  std::ostringstream wait;
  wait << "for i in $(seq 600); do [ $(cat " << file.string() << " 2>/dev/null | wc -l) -gt " << lines
       << " ] && break; sleep 0.1; done; ";
  return wait.str();
}

/// Runs the program, each test in a folder of its own.
class Run : public testing::Test {
 protected:
  /// Runs the program and returns its exit code.
  int motorcade(const std::string& arguments, const std::string& prefix = "") {
    const std::string command =
        prefix + MOTORCADE_PROGRAM " " + arguments + " >" + (folder_ / "stdout").string() + " 2>" + errors().string();
    return WEXITSTATUS(std::system(command.c_str()));
  }
  int run(const std::string& name, const std::string& options = "", const fs::path& sequence = kSequence) {
    return motorcade("run " + sequence.string() + " --out " + out(name).string() + " " + options);
  }
  fs::path out(const std::string& name) const { return folder_ / name; }
  fs::path errors() const { return folder_ / "stderr"; }
  nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(contentOf(out(name) / "summary.json"));
  }

  /// Measures of a run against the truth of its sequence.
  nlohmann::json evaluate(const std::string& name, const fs::path& sequence = kSequence) {
    const fs::path file = folder_ / (name + ".json");
    EXPECT_EQ(
        motorcade("evaluate " + out(name).string() + " --sequence " + sequence.string() + " --json " + file.string()),
        0)
        << contentOf(errors());
    return nlohmann::json::parse(contentOf(file));
  }

  /// A copy of the rendered drive with one image cut short.
  fs::path damagedSequence() {
    fs::path copy = folder_ / "damaged";
    fs::copy(kSequence, copy, fs::copy_options::recursive);
    for (const auto& entry : fs::directory_iterator(copy / "image_0"))
      if (entry.path().stem() == "000003") fs::resize_file(entry.path(), 100);
    return copy;
  }

  void expectSame(const std::string& a, const std::string& b) {
    for (const std::string& file : kReproducible)
      EXPECT_TRUE(contentOf(out(a) / file) == contentOf(out(b) / file)) << file;
  }

 private:
  const TemporaryFolder folder_;
};

}  // namespace motorcade::test
