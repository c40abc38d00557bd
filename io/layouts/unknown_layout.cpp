#include <algorithm>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/text_file.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/layouts/unsupported.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFoldersNamed = 6;

/// Content of a folder, as a message describes it.
struct Content {
  std::vector<fs::path> of_images;  // sub-folders with images
  std::vector<std::string> folders, calibrations;
  std::vector<fs::path> recordings;  // bags and videos
  std::size_t images = 0;
};

std::string numbered(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Content contentOf(const fs::path& folder) {
  Content content;
  content.images = listImages(folder).size();
  for (const fs::path& entry : listFolder(folder)) {
    const std::string name = printable(entry.filename().string());
    const std::string extension = entry.extension().string();
    if (fs::is_directory(entry)) {
      const std::size_t images = listImages(entry).size();
      if (images > 0) content.of_images.push_back(entry);
      content.folders.push_back(name + " (" + numbered(images, "image") + ")");
    } else if (isRecordingFile(entry)) {
      content.recordings.push_back(entry);
    } else if (extension == ".yaml" || extension == ".yml" || extension == ".json" || extension == ".txt") {
      content.calibrations.push_back(name);
    }
  }
  return content;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostFoldersNamed); ++i) text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMostFoldersNamed) text += " and " + std::to_string(names.size() - kMostFoldersNamed) + " more";
  return text;
}

std::string described(const Content& content) {
  std::string text = numbered(content.images, "image");
  if (!content.folders.empty()) text += "; folders " + listed(content.folders);
  if (!content.calibrations.empty()) text += "; files " + listed(content.calibrations);
  if (!content.recordings.empty())
    text += "; recordings " + listed({printable(content.recordings.front().filename().string())});
  return text;
}

/// The folders in it that are sequences.
std::vector<std::string> sequencesIn(const fs::path& folder) {
  constexpr std::size_t kMostTried = 50;
  std::vector<std::string> names;
  std::size_t tried = 0;
  for (const fs::path& entry : listFolder(folder)) {
    if (!fs::is_directory(entry) || ++tried > kMostTried) continue;
    try {
      if (openKnownLayout({entry, 10, {}})) names.push_back(printable(entry.filename().string()));
    } catch (const std::exception&) {
      continue;  // it may be one, but not as it is
    }
  }
  return names;
}

/// Advice on how to turn the content of the folder into a sequence.
std::string advice(const fs::path& folder, const Content& content) {
  if (const auto variations = virtualKittiVariations(folder); !variations.empty())
    return "\nThese folders in it are drives of Virtual KITTI 2: " + listed(variations) +
           ". Name one of them, or run all:\n  motorcade batch perf/datasets/virtual_kitti_2.toml --root ROOT --out "
           "BATCH    (ROOT holds Scene01, ...)";
  if (const auto sequences = sequencesIn(folder); !sequences.empty())
    return "\nThese folders in it are sequences: " + listed(sequences) + ". Name one of them.";
  if (const auto others = otherImages(folder); !others.empty()) return "\n" + adviceOnOtherImages(others);
  if (content.images == 0 && content.of_images.empty())
    return "\nImages are PNG, JPEG or PGM files: lay those of the left camera into a folder left, those of the right "
           "one "
           "into right, and a calib.txt, camchain.yaml or left.yaml and right.yaml beside them.";
  if (content.of_images.size() >= 2) return adviceOnTwoFolders(content.of_images[0], content.of_images[1]);
  return adviceOnOneFolder(listImages(content.images > 0 ? folder : content.of_images.front()));
}

}  // namespace

void failUnknownLayout(const fs::path& path) {
  if (fs::is_regular_file(path)) throw InputError(path.string() + adviceOnFile(path));
  const Content content = contentOf(path);
  if (content.recordings.size() == 1 && content.of_images.empty() && content.images == 0)
    throw InputError(content.recordings.front().string() + adviceOnFile(content.recordings.front()));
  throw InputError(path.string() + ": holds no stereo sequence that is understood; it holds " + described(content) +
                   "." + advice(path, content));
}

}  // namespace motorcade
