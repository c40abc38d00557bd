#pragma once

#include <filesystem>
#include <optional>

#include "apps/draw/marks.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/images/image_file.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Images to draw on: the left one and the mask of the objects, where there is one.
struct DrawnImages {
  Image left;
  std::optional<Gray16Image> mask{};
};

/// Paints each object's mask, points, cuboid and tag onto a sheet that already shows the left image, pixel by pixel.
/// The box is drawn where no cuboid is known. Its path of the last seconds and an arrow of one second's motion lie on
/// the ground. The tag tells kind, distance and speed.
void paintImageView(Sheet& sheet, const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

/// Paints the scene from above, the camera heading right, over a grid in meters. It shows the paths so far of camera
/// and objects. Objects have their points, their footprints as far as they were seen, the 2-sigma ellipses of their
/// middles, and their motion of one second. The truth is dashed, that of parked cars dotted.
void paintTopView(Sheet& sheet, const RecordedDrive& drive, std::size_t frame);

/// Reads the left image of a frame, and the mask where the run wrote masks. Throws InputError naming the file.
DrawnImages readDrawnImages(const Sequence& sequence, std::size_t frame, const std::filesystem::path& run_folder,
                            PairReader& reader);

/// The left image above the view from the top, with facts about the frame between them and a legend below. All frames
/// of a drive have the same size.
RgbImage drawFrame(const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

}  // namespace motorcade
