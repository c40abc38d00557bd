#include "apps/interface/pair_input.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "apps/interface/gray_image.hpp"
#include "apps/interface/vehicle_motion_input.hpp"

namespace motorcade {
namespace {

/// Puts as many buffers into the pool as images are ever in use at once: in flight, in the entrance and in the stages'
/// memories. Some are spare, as a pool may miss a buffer that comes back in that moment. Their pages are untouched, and
/// so cost no memory until they are used.
void stock(ImagePool& pool, const Camera& camera) {
  constexpr std::size_t kImages = 32;
  std::vector<Image> images;
  while (images.size() < kImages) images.push_back(pool.acquire(camera.width_px, camera.height_px));
}

const char* problemOfLabels(const Pair::Image& labels, const Camera& camera) {
  if (labels.pixels == nullptr) return nullptr;
  if (labels.width_px != camera.width_px || labels.height_px != camera.height_px)
    return "the instance labels are not of the camera's size";
  if (labels.format != Pair::Format::kGray8 && labels.format != Pair::Format::kGray16)
    return "the instance labels are not gray of 8 or 16 bits";
  const int pixel_bytes = labels.format == Pair::Format::kGray16 ? 2 : 1;
  if (labels.stride_bytes != 0 && labels.stride_bytes < std::int64_t{labels.width_px} * pixel_bytes)
    return "the instance labels' stride is shorter than their rows";
  if (labels.stride_bytes > kMostStride_bytes) return "the instance labels' stride is above 2^24 bytes";
  return nullptr;
}

/// The caller's rows need not be aligned.
void copyLabels(const Pair::Image& given, InstanceLabels& labels) {
  const auto width = static_cast<std::size_t>(given.width_px);
  const auto* row = static_cast<const std::uint8_t*>(given.pixels);
  for (int y = 0; y < given.height_px; ++y, row += strideOf(given))
    if (given.format == Pair::Format::kGray16)
      std::memcpy(labels.mutableRow(y), row, 2 * width);
    else
      std::copy_n(row, width, labels.mutableRow(y));
}

}  // namespace

PairInput::PairInput(const Camera& camera, const CameraModel& model, Tracker::Policy policy)
    : camera_(camera), model_(model), stocked_labels_(policy == Tracker::Policy::kReplay) {
  if (policy == Tracker::Policy::kLive) stock(images_, camera);
}

const char* PairInput::problemWith(const Pair& pair) const {
  if (pair.frame < -1 || pair.frame > kFarthestStamp_ns) return "its number is neither -1 nor one from 0 to 2^62";
  if (pair.stamp_ns < -kFarthestStamp_ns || pair.stamp_ns > kFarthestStamp_ns) return "its stamp is beyond 2^62 ns";
  if (const char* const problem = problemOf(pair.left, camera_)) return problem;
  if (const char* const problem = problemOf(pair.right, camera_)) return problem;
  return problemOfLabels(pair.instances, camera_);
}

StereoFrame PairInput::frameOf(const Pair& pair, int sample_bits) {
  StereoFrame frame;
  frame.head = {.frame = {pair.frame}, .stamp = {pair.stamp_ns}};
  frame.inputs = model_.inputs();
  frame.due = std::chrono::steady_clock::now();
  frame.left = model_.leftOf(grayImage(pair.left, sample_bits, images_), images_);
  frame.right = model_.rightOf(grayImage(pair.right, sample_bits, images_), images_);
  frame.inputs.instances = labelsOf(pair.instances);
  return frame;
}

std::shared_ptr<const InstanceLabels> PairInput::labelsOf(const Pair::Image& given) {
  if (given.pixels == nullptr) return nullptr;
  if (!stocked_labels_) stockLabels();
  auto labels = labels_.acquire();
  labels->resize(given.width_px, given.height_px);
  copyLabels(given, *labels);
  return labels;
}

/// Makes room for the labels of all pairs that are ever in use at once, and some spare. Most callers have no labels,
/// and pay nothing.
void PairInput::stockLabels() {
  constexpr std::size_t kPairs = 16;
  std::vector<std::shared_ptr<InstanceLabels>> all;
  while (all.size() < kPairs) {
    all.push_back(labels_.acquire());
    all.back()->reserve(camera_.width_px, camera_.height_px);
  }
  stocked_labels_ = true;
}

}  // namespace motorcade
