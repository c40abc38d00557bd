#include <array>

#include "io/results/pose_graph.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// A g2o file, whose edges can all be used.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  constexpr std::array<std::string_view, 1> kNoLine{": holds no pose and no edge"};
  const auto& path = file.holding(fuzz::textOf(data, size));
  fuzz::readOrRefuse(path.native(), kNoLine, [&] {
    const PoseGraph graph = readPoseGraph(path);
    for (const auto& edge : graph.edges) {
      fuzz::require(edge.information.allFinite(), "an information that is not finite");
      fuzz::require(edge.from != edge.to && edge.from >= 0 && edge.to >= 0, "an edge without ends");
      if (const auto* T = std::get_if<SE3>(&edge.measured))
        fuzz::require((T->rotation() * T->rotation().transpose()).isIdentity(1e-9), "a motion that does not turn");
    }
    for (const auto& problem : graph.problems) fuzz::requireClear("file, " + problem.detail, "file", {});
  });
  return 0;
}
