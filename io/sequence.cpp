#include "io/sequence.hpp"

#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "io/errors.hpp"
#include "io/layouts/layouts.hpp"

namespace motorcade {

namespace fs = std::filesystem;

FrameRange parseFrameRange(std::string_view text) {
  const auto colon = text.find(':');
  const auto bad = [&] {
    return UsageError("--frames " + std::string(text) + ": write A:B, the first frame and the one after the last");
  };
  if (colon == std::string_view::npos) throw bad();
  const auto parse = [&](std::string_view part, std::size_t when_empty) {
    if (part.empty()) return when_empty;
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) throw bad();
    return value;
  };
  const FrameRange everything;
  const FrameRange range{parse(text.substr(0, colon), everything.begin), parse(text.substr(colon + 1), everything.end)};
  if (range.size() == 0) throw bad();
  return range;
}

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

FrameRange selectedFrames(std::string_view text, const Sequence& sequence) {
  const FrameRange range = (text.empty() ? FrameRange{} : parseFrameRange(text)).within(sequence.frames.size());
  if (range.size() == 0)
    throw UsageError("--frames " + std::string(text) + ": the sequence has " + std::to_string(sequence.frames.size()) +
                     " frames, none of these");
  return range;
}

}  // namespace motorcade
