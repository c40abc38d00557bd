#include <fstream>

#include <stdlib.h>

#include "io/results/object_points.hpp"
#include "io/results/run_folder.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

namespace {

namespace fs = std::filesystem;

/// A run folder, empty but for one table, which is a link to the input; the input's first bytes choose it.
class LinkedRun {
 public:
  LinkedRun() {
    std::string pattern = (fs::temp_directory_path() / "motorcade_fuzz_XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    std::ofstream(folder_ / "camera_final.txt");
  }
  ~LinkedRun() { fs::remove_all(folder_); }

  fs::path holding(std::string_view bytes) {
    const fs::path link = folder_ / nameOf(bytes);
    fs::remove(last_);
    fs::create_symlink(file_.holding(bytes), link);
    return last_ = link;
  }

 private:
  static std::string nameOf(std::string_view bytes) {
    if (bytes.starts_with("frame,status")) return "frames.csv";
    if (bytes.starts_with("frame,track_id,state")) return "objects_final.csv";
    if (bytes.starts_with("frame,track_id,point_id")) return kObjectPointsFile;
    if (bytes.starts_with("frame,track_id,c")) return "covariances.csv";
    return "camera_online.txt";
  }

  fuzz::MemoryFile file_;
  fs::path folder_, last_{"none"};
};

}  // namespace

/// A table of a run.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static LinkedRun run;
  const fs::path file = run.holding(fuzz::textOf(data, size));
  fuzz::readOrRefuse(file.native(), {}, [&] {
    if (file.filename() == kObjectPointsFile) {
      for (const ObjectPoint& point : readObjectPoints(file)) objectPointLine(point);
      return;
    }
    readRunFolder(file.parent_path());
  });
  return 0;
}
