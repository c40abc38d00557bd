#include "apps/evaluate/measures/shape_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "apps/evaluate/comparison/overlap.hpp"
#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"

namespace motorcade {
namespace {

/// The angle between two axes, as if neither had a front.
double turn_deg(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double sine = std::abs(a.x() * b.y() - a.y() * b.x());
  return std::asin(std::min(1.0, sine)) * 180 / std::numbers::pi;
}

struct Sums {
  std::vector<double> center_m, heading_deg, length_m, width_m, height_m;
  void add(const UprightCuboid& estimate, const UprightCuboid& label) {
    center_m.push_back((estimate.middle - label.middle).norm());
    heading_deg.push_back(turn_deg(label.ahead, estimate.ahead));
    length_m.push_back(std::abs(estimate.size_m.x() - label.size_m.x()));
    width_m.push_back(std::abs(estimate.size_m.y() - label.size_m.y()));
    height_m.push_back(std::abs(estimate.size_m.z() - label.size_m.z()));
  }
};

namespace fs = std::filesystem;

/// Pixels, as separate columns and rows. The loop over all pairs of two boundaries takes all of the time.
struct Pixels {
  std::vector<int> x, y;
  std::size_t size() const { return x.size(); }
};

Pixels boundaryOf(const PixelsOf& mask) {
  Pixels boundary;
  const int width = mask.image->width, height = mask.image->height;
  const auto begin = mask.image->pixels.begin(), end = mask.image->pixels.end();
  for (auto at = std::find(begin, end, mask.value); at != end; at = std::find(at + 1, end, mask.value)) {
    const int x = static_cast<int>(at - begin) % width, y = static_cast<int>(at - begin) / width;
    const bool ends = (x > 0 && !mask.has(x - 1, y)) || (x + 1 < width && !mask.has(x + 1, y)) ||
                      (y > 0 && !mask.has(x, y - 1)) || (y + 1 < height && !mask.has(x, y + 1));
    if (!ends) continue;
    boundary.x.push_back(x);
    boundary.y.push_back(y);
  }
  return boundary;
}

/// Sum over `from` of the distances to the nearest of `to`.
double distances_px(const Pixels& from, const Pixels& to) {
  double sum_px = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    int nearest_px2 = std::numeric_limits<int>::max();
    for (std::size_t k = 0; k < to.size(); ++k) {
      const int dx = from.x[i] - to.x[k], dy = from.y[i] - to.y[k];
      nearest_px2 = std::min(nearest_px2, dx * dx + dy * dy);
    }
    sum_px += std::sqrt(nearest_px2);
  }
  return sum_px;
}

/// A frame's masks and its true instances.
struct MaskPair {
  Gray16Image masks, instances;
};

/// Empty for a frame whose masks were not written.
std::optional<MaskPair> readPair(FrameId frame, const fs::path& masks, const fs::path& instances) {
  const fs::path file = maskFile(masks, frame), truth_file = instanceFile(instances, frame);
  if (!fs::exists(file)) return std::nullopt;
  MaskPair pair{readPng16(file), readInstances(truth_file)};
  if (pair.masks.width != pair.instances.width || pair.masks.height != pair.instances.height)
    throw InputError(file.string() + ": is not of the size of " + truth_file.string() +
                     "; evaluate the run with the sequence that it was made of");
  return pair;
}

struct MaskSums {
  MaskErrors errors;
  std::vector<double> boundary_px;

  void add(const PixelsOf& mask, const PixelsOf& truth) {
    ++errors.rows;
    if (std::ranges::find(mask.image->pixels, mask.value) == mask.image->pixels.end()) return;
    ++errors.rows_with_mask;
    errors.iou_of_masks += maskIou(mask, truth);
    if (const auto distance_px = boundaryDistance_px(mask, truth)) boundary_px.push_back(*distance_px);
  }
  MaskErrors means() && {
    errors.iou = errors.iou_of_masks / std::max(1, errors.rows);
    errors.iou_of_masks /= std::max(1, errors.rows_with_mask);
    errors.boundary_px = statisticsOf(std::move(boundary_px));
    return errors;
  }
};

}  // namespace

BoxErrors boxErrors(const std::vector<ComparedFrame>& frames, double from_m, double to_m) {
  BoxErrors errors;
  Sums sums;
  for (const auto& [frame, object, row] : askedPairs(frames, from_m, to_m)) {
    ++errors.rows;
    const double iou = intersectionOverUnion(row->row.object.box, object->truth.box);
    errors.iou_2d += iou;
    errors.over_half_2d += iou > 0.5;
    if (!row->row.object.cuboid) continue;
    ++errors.rows_with_cuboid;
    const UprightCuboid estimate = estimatedCuboid(frame->T_world_cam, row->row.object),
                        label = labeledCuboid(object->truth);
    errors.iou_bird += footprintIou(estimate, label);
    errors.iou_3d += volumeIou(estimate, label);
    sums.add(estimate, label);
    const Eigen::Array3d two_sigma_m = 2 * row->row.object.cuboid->size_sigma_m.array();
    errors.size_within_2_sigma += ((estimate.size_m - label.size_m).array().abs() <= two_sigma_m).cast<double>();
  }
  for (double* sum : {&errors.iou_2d, &errors.over_half_2d}) *sum /= std::max(1, errors.rows);
  for (double* sum : {&errors.iou_bird, &errors.iou_3d}) *sum /= std::max(1, errors.rows_with_cuboid);
  errors.size_within_2_sigma /= std::max(1, errors.rows_with_cuboid);
  errors.center_m = statisticsOf(std::move(sums.center_m));
  errors.heading_deg = statisticsOf(std::move(sums.heading_deg));
  errors.length_m = statisticsOf(std::move(sums.length_m));
  errors.width_m = statisticsOf(std::move(sums.width_m));
  errors.height_m = statisticsOf(std::move(sums.height_m));
  return errors;
}

double maskIou(const PixelsOf& a, const PixelsOf& b) {
  int both = 0, either = 0;
  for (std::size_t i = 0; i < a.image->pixels.size(); ++i) {
    const bool in_a = a.image->pixels[i] == a.value, in_b = b.image->pixels[i] == b.value;
    both += in_a && in_b;
    either += in_a || in_b;
  }
  return either > 0 ? static_cast<double>(both) / either : 0;
}

std::optional<double> boundaryDistance_px(const PixelsOf& a, const PixelsOf& b) {
  const auto of_a = boundaryOf(a), of_b = boundaryOf(b);
  if (of_a.size() == 0 || of_b.size() == 0) return std::nullopt;
  return (distances_px(of_a, of_b) + distances_px(of_b, of_a)) / static_cast<double>(of_a.size() + of_b.size());
}

std::optional<MaskEvaluation> maskErrors(const std::vector<ComparedFrame>& online, const fs::path& masks,
                                         const fs::path& instances) {
  if (!fs::is_directory(masks)) return std::nullopt;
  MaskSums near, far;
  const ComparedFrame* read_for = nullptr;
  std::optional<MaskPair> images;
  for (const auto& [frame, object, row] : askedPairs(online, 0, kFar_m)) {
    if (frame != read_for) images = readPair(frame->frame, masks, instances);
    read_for = frame;
    if (!images) continue;
    const PixelsOf mask{&images->masks, maskValue(row->row.object.track)},
        truth{&images->instances, static_cast<std::uint16_t>(object->truth.id + 1)};
    (object->range_m() < kNear_m ? near : far).add(mask, truth);
  }
  return MaskEvaluation{std::move(near).means(), std::move(far).means()};
}

}  // namespace motorcade
