#pragma once

#include "apps/draw/marks.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// The scene from above, the camera heading right, over a grid in meters. It shows the paths so far of camera and
/// objects. Objects have their points, their footprints as far as they were seen, the 2-sigma ellipses of their
/// middles, and their motion of one second. The truth is dashed, that of parked cars dotted. A legend stands below
/// where there is room for it.
RgbImage drawTopView(const RecordedDrive& drive, std::size_t frame, ImageSize size);

/// The same without a legend, over the whole sheet.
void paintTopView(Sheet& sheet, const RecordedDrive& drive, std::size_t frame);

}  // namespace motorcade
