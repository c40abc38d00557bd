#include "io/layouts/open_sequence.hpp"

#include <optional>
#include <utility>

#include "io/files/errors.hpp"
#include "io/layouts/layouts.hpp"

namespace motorcade {

namespace fs = std::filesystem;

std::optional<Sequence> openKnownLayout(const SequenceSource& source) {
  for (const auto open : {openImageList, openEuroc, openKitti360, openVirtualKitti, openKittiRaw, openArgoverse,
                          openKittiTracking, openPlain})
    if (auto sequence = open(source)) return sequence;
  return std::nullopt;
}

Sequence openSequence(const fs::path& path, double fps_hz, const GivenCameras& given) {
  if (path == kStandardInput) throw UsageError("-: a stream on the standard input is read by `motorcade run` alone");
  // Layouts look at parent folders, so that "." and a trailing slash must go.
  SequenceSource source{fs::absolute(path).lexically_normal(), fps_hz, given};
  if (!source.path.has_filename()) source.path = source.path.parent_path();
  try {
    if (auto sequence = openKnownLayout(source)) return *std::move(sequence);
    if (!fs::exists(path)) throw InputError(path.string() + ": does not exist");
    failUnknownLayout(source.path);
  } catch (const fs::filesystem_error& error) {
    throw InputError(error.path1().string() + ": " + error.code().message());
  }
}

}  // namespace motorcade
