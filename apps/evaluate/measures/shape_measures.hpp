#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "io/images/image_file.hpp"

/// Agreement of boxes, cuboids and masks with the labels'. Boxes and cuboids are those of the reported rows that were
/// matched to labels which are asked for; masks are compared with the objects' true pixels.
namespace motorcade {

/// Errors of the matched rows in one range of distances.
struct BoxErrors {
  int rows = 0, rows_with_cuboid = 0;
  double iou_2d = 0, over_half_2d = 0;  // mean, and share above 1/2, in the left image
  double iou_bird = 0, iou_3d = 0;      // means, as seen from the camera
  /// |estimated - labeled|: middle of the footprint, heading (up to half a turn), length, width, height.
  Statistics center_m, heading_deg, length_m, width_m, height_m;
  /// Shares of the cuboids whose length, width and height differ from the label's by at most two of their standard
  /// deviations: .954 of normally distributed errors.
  Eigen::Array3d size_within_2_sigma = Eigen::Array3d::Zero();
};

BoxErrors boxErrors(const std::vector<ComparedFrame>& frames, double from_m, double to_m);

/// The pixels of an image that have a value.
struct PixelsOf {
  const Gray16Image* image;
  std::uint16_t value;
  bool has(int x, int y) const { return image->pixels[static_cast<std::size_t>(y) * image->width + x] == value; }
};

/// Pixels in both over pixels in either, of images of the same size; 0 where neither has any.
double maskIou(const PixelsOf& a, const PixelsOf& b);

/// Distance of two outlines [px]: the mean over the boundary pixels of both of the distance to the nearest boundary
/// pixel of the other. A boundary pixel belongs to the mask and has a neighbor (of four) in the image that does not.
/// Objects have no boundary where the image's border cuts them. Empty when one of the masks has none.
std::optional<double> boundaryDistance_px(const PixelsOf& a, const PixelsOf& b);

/// Errors of the reported rows on labels that are asked for, in frames whose masks exist.
struct MaskErrors {
  int rows = 0, rows_with_mask = 0;  // all, and those with a pixel of the track in their frame's mask
  double iou = 0;                    // mean over all rows, 0 for one without mask
  double iou_of_masks = 0;           // mean over the rows with mask
  Statistics boundary_px;            // of the rows with mask
};

/// Errors by range of distances.
struct MaskEvaluation {
  MaskErrors within_30m, from_30_to_50m;
};

/// Compares the masks of the online estimate with the label's numbers plus one in `instances`. Empty when `masks` is no
/// folder. Throws InputError naming the file where the two differ in size or a frame's instances are missing.
std::optional<MaskEvaluation> maskErrors(const std::vector<ComparedFrame>& online, const std::filesystem::path& masks,
                                         const std::filesystem::path& instances);

}  // namespace motorcade
