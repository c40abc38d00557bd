#include <algorithm>
#include <string>

#include "io/errors.hpp"
#include "io/layouts/layout_cameras.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/text_file.hpp"
#include "io/timestamps.hpp"

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
  if (list.frames.empty()) throw InputError(file.string() + ": holds no line LEFT RIGHT or STAMP LEFT RIGHT");
  return list;
}

/// The camera from what lies beside the list.
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
  for (const char* other : {".bag", ".mcap", ".db3"})
    if (file.extension() == other) return std::nullopt;
  List list = readList(file);
  Sequence sequence{.folder = file, .layout = "list", .frames = std::move(list.frames)};
  sequence.truth.poses = ifExists(file.parent_path() / "poses.txt");
  setCamera(sequence, source.given, [&](ImageSize size) { return cameraBeside(sequence, file.parent_path(), size); });
  if (list.stamps.empty()) {
    setStamps(sequence, {}, source.fps_hz);
  } else {
    sequence.stamps = parseTimestamps(file, list.stamps);
    sequence.stamps_measured = true;
  }
  return sequence;
}

}  // namespace motorcade
