#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/layouts/layout_cameras.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/layouts/unsupported.hpp"
#include "io/sequence/frame_lines.hpp"
#include "io/sequence/pairing.hpp"
#include "io/sequence/timestamps.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{1} << 28;

struct List {
  std::vector<FramePaths> frames;
  std::vector<TextLine> stamps;  // as they are written; none where the lines have only two fields
};

/// The fields of a line, between commas where it has any, else between blanks.
std::vector<std::string> fieldsOf(const fs::path& file, const TextLine& line) {
  const bool commas = line.text.find(',') != std::string::npos;
  FieldReader reader(file, line, commas ? ',' : ' ');
  std::vector<std::string> fields;
  while (!reader.atEnd()) fields.push_back(trimmed(reader.word("a field")));
  return fields;
}

void markMissing(std::vector<FramePaths>& frames) {
  for (FramePaths& frame : frames) {
    frame.left_missing = !fs::exists(frame.left);
    frame.right_missing = !fs::exists(frame.right);
  }
}

/// Names the images that are not there. Throws InputError where hardly any pair is.
void tellMissingFiles(Sequence& sequence) {
  std::vector<fs::path> missing;
  for (const FramePaths& frame : sequence.frames)
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight})
      if (frame.isMissing(side)) missing.push_back(frame.of(side));
  if (missing.empty()) return;
  const auto pairs = std::ranges::count_if(sequence.frames, &FramePaths::isPair);
  const std::string text = sequence.folder.string() + ": names " + std::to_string(missing.size()) +
                           " images that are not there (" + namesOf(missing) + "); " + std::to_string(pairs) + " of " +
                           std::to_string(sequence.frames.size()) + " lines are pairs";
  if (2 * pairs < std::ssize(sequence.frames)) throw InputError(text + "; paths are relative to the file");
  sequence.notes.push_back({"pairs", text + ", the other frames have no images and a predicted pose"});
}

/// Notes lines that pair different numbers while other lines do not. Such a list was made of two folders in order while
/// an image was missing.
void tellUnlikePairs(Sequence& sequence) {
  std::map<std::int64_t, std::int64_t> counts;  // of the differences of a line's numbers
  std::vector<std::pair<FramePaths, std::int64_t>> differences;
  for (const FramePaths& frame : sequence.frames) {
    const auto left = imageNumber(frame.left), right = imageNumber(frame.right);
    if (!left || !right) return;
    differences.emplace_back(frame, *right - *left);
    ++counts[*right - *left];
  }
  const std::int64_t same = counts.contains(0) ? counts.at(0) : 0;
  if (same == 0 || counts.size() == 1) return;
  const auto unlike = std::ranges::find_if(differences, [](const auto& entry) { return entry.second != 0; });
  sequence.notes.push_back({"pairs",
                            sequence.folder.string() + ": " + std::to_string(std::ssize(sequence.frames) - same) +
                                " lines bring together images of different numbers (" +
                                namesOf({unlike->first.left, unlike->first.right}) + "), " + std::to_string(same) +
                                " those of the same one",
                            2 * same >= std::ssize(sequence.frames)});
}

List readList(const fs::path& file) {
  List list;
  for (const TextLine& line : readLines(file, LastLine::kKeep, kMostBytes)) {
    if (line.text.starts_with('#')) continue;
    const auto fields = fieldsOf(file, line);
    const bool stamped = fields.size() == 3;
    if ((fields.size() != 2 && !stamped) || (!list.frames.empty() && stamped != !list.stamps.empty()))
      throw InputError(file.string() + ", line " + std::to_string(line.number) +
                       ": write LEFT RIGHT or STAMP LEFT RIGHT, the same in every line");
    if (stamped) list.stamps.push_back({line.number, fields.front()});
    const fs::path folder = file.parent_path();
    list.frames.push_back({folder / fields[fields.size() - 2], folder / fields.back()});
  }
  markMissing(list.frames);
  if (list.frames.empty()) throw InputError(file.string() + ": holds no line LEFT RIGHT or STAMP LEFT RIGHT");
  return list;
}

/// The camera from the files beside the list.
StereoCamera cameraBeside(Sequence& sequence, const fs::path& folder, ImageSize size) {
  if (const auto camera = cameraIn(sequence, folder, {.any_pair = true}, size)) return *camera;
  throw InputError(sequence.folder.string() +
                   ": a list of images needs a calibration; give --camera fx,fy,cx,cy,baseline or --calibration FILE, "
                   "or lay calib.txt beside it" +
                   calibrationsMeant(folder));
}

}  // namespace

std::optional<Sequence> openImageList(const SequenceSource& source) {
  const fs::path& file = source.path;
  if (!fs::is_regular_file(file)) return std::nullopt;
  if (isRecordingFile(file) || imageFormat(file) != ImageFormat::kUnknown) return std::nullopt;
  List list = readList(file);
  Sequence sequence{.folder = file, .layout = "list", .frames = std::move(list.frames)};
  sequence.truth.poses = ifExists(file.parent_path() / "poses.txt");
  tellMissingFiles(sequence);
  tellUnlikePairs(sequence);
  setCamera(sequence, source.given, [&](ImageSize size) { return cameraBeside(sequence, file.parent_path(), size); });
  if (list.stamps.empty()) {
    setStamps(sequence, {}, source.fps_hz);
  } else {
    Times times = parseTimes(file, list.stamps);
    sequence.stamps = std::move(times.stamps);
    sequence.stamps_measured = true;
    if (times.unit_ns > 1) tellUnit(sequence, times, file);  // nanoseconds may be as they are
    tellPeriod(sequence);
  }
  return sequence;
}

}  // namespace motorcade
