#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "apps/draw/drawn_images.hpp"
#include "apps/draw/frame_view.hpp"
#include "apps/html/html_page.hpp"
#include "apps/report/report_sections.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kPictures = 4;
constexpr int kQuality = 78;  // of JPEG

/// The frame with the most objects in each quarter of the drive, the earliest of equals.
std::vector<std::size_t> chosenFrames(const RecordedDrive& drive) {
  const std::size_t frames = drive.T_world_cam.size();
  std::set<std::size_t> chosen;
  for (std::size_t part = 0; part < kPictures; ++part) {
    const std::size_t begin = frames * part / kPictures, end = frames * (part + 1) / kPictures;
    if (begin == end) continue;
    std::size_t best = (begin + end) / 2;
    for (std::size_t frame = begin; frame < end; ++frame)
      if (drive.objectsAt(frame).size() > drive.objectsAt(best).size()) best = frame;
    chosen.insert(best);
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace

std::string pictureSection(const ReportedRun& reported) {
  if (!reported.sequence) return "";
  const RecordedDrive& drive = reported.drive;
  PairReader reader(*reported.sequence);
  std::string text;
  for (const std::size_t frame : chosenFrames(drive)) {
    try {
      const auto number = static_cast<std::size_t>(drive.first_frame) + frame;
      const DrawnImages images = readDrawnImages(*reported.sequence, number, reported.run.folder, reader);
      const std::string jpeg = encodeJpeg(drawFrame(images, drive, frame), kQuality);
      text += fmt::format("<figure><img alt=\"frame {}\" src=\"{}\"></figure>\n", number, dataUri("image/jpeg", jpeg));
    } catch (const InputError& problem) {
      text += "<p class=\"muted\">" + escaped(problem.what()) + "</p>\n";
    }
  }
  return text.empty() ? "" : "<h2>As the camera saw it</h2>\n" + text;
}

}  // namespace motorcade
