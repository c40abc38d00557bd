#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/sequence/sequence.hpp"

/// One function per layout: each returns a sequence if the folder has its layout, and nothing otherwise.
namespace motorcade {

/// The user's path and options. The path is absolute and has no slash at its end.
struct SequenceSource {
  std::filesystem::path path;
  double fps_hz = 10;
  GivenCameras given{};
};

std::optional<Sequence> openKittiRaw(const SequenceSource& source);
std::optional<Sequence> openKittiTracking(const SequenceSource& source);
std::optional<Sequence> openKitti360(const SequenceSource& source);
std::optional<Sequence> openEuroc(const SequenceSource& source);
std::optional<Sequence> openVirtualKitti(const SequenceSource& source);
std::optional<Sequence> openArgoverse(const SequenceSource& source);
std::optional<Sequence> openPlain(const SequenceSource& source);
std::optional<Sequence> openImageList(const SequenceSource& source);

/// Opens the sequence by the first layout that finds its own.
std::optional<Sequence> openKnownLayout(const SequenceSource& source);

/// The variations of Virtual KITTI 2 in a folder with scenes or in that of a scene, as paths in it. Empty in others.
std::vector<std::string> virtualKittiVariations(const std::filesystem::path& folder);

/// Throws InputError that describes the content of the path, and what to write or run so that it can be used.
[[noreturn]] void failUnknownLayout(const std::filesystem::path& path);

}  // namespace motorcade
