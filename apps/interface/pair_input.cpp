#include "apps/interface/pair_input.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "io/images/sample_bits.hpp"

namespace motorcade {

const char* problemOf(const VehicleMotion& motion) {
  constexpr double kMaxSpeed_mps = 150, kMaxYawRate_radps = 10;  // of anything with wheels
  if (motion.stamp_ns < -kFarthestStamp_ns || motion.stamp_ns > kFarthestStamp_ns) return "its stamp is beyond 2^62 ns";
  if (!(std::abs(motion.speed_mps) <= kMaxSpeed_mps)) return "its speed is no number up to 150 m/s";
  if (!(std::abs(motion.yaw_rate_radps) <= kMaxYawRate_radps)) return "its yaw rate is no number up to 10 rad/s";
  const bool known = motion.speed_sigma_mps >= 0 && motion.yaw_rate_sigma_radps >= 0 &&
                     std::isfinite(motion.speed_sigma_mps) && std::isfinite(motion.yaw_rate_sigma_radps);
  return known ? nullptr : "a standard deviation of it is negative, or no number; 0 leaves it open";
}

VehicleMotionSample sampleOf(const VehicleMotion& motion) {
  return {.stamp = {motion.stamp_ns},
          .speed_mps = motion.speed_mps,
          .yaw_rate_radps = motion.yaw_rate_radps,
          .speed_sigma_mps = motion.speed_sigma_mps,
          .yaw_rate_sigma_radps = motion.yaw_rate_sigma_radps};
}

namespace {

std::ptrdiff_t bytesPerPixel(Pair::Format format) {
  switch (format) {
    case Pair::Format::kGray8:
      return 1;
    case Pair::Format::kGray16:
      return 2;
    case Pair::Format::kRgb8:
    case Pair::Format::kBgr8:
      return 3;
  }
  return 0;
}

/// The caller's rows need not be aligned.
std::uint16_t sampleAt(const void* row, int x) {
  std::uint16_t value = 0;
  std::memcpy(&value, static_cast<const std::uint8_t*>(row) + std::ptrdiff_t{2} * x, sizeof value);
  return value;
}

void fillFrom16(const void* row, std::uint8_t* gray, int width, int sample_bits) {
  for (int x = 0; x < width; ++x) gray[x] = upperBits(sampleAt(row, x), sample_bits);
}

void fillFromColors(const void* row, std::uint8_t* gray, int width, int red, int blue) {
  const auto* bytes = static_cast<const std::uint8_t*>(row);
  for (int x = 0; x < width; ++x, bytes += 3) gray[x] = grayOf(bytes[red], bytes[1], bytes[blue]);
}

void fillRow(const void* row, Pair::Format format, int sample_bits, std::uint8_t* gray, int width) {
  switch (format) {
    case Pair::Format::kGray8:
      std::memcpy(gray, row, static_cast<std::size_t>(width));
      break;
    case Pair::Format::kGray16:
      fillFrom16(row, gray, width, sample_bits);
      break;
    case Pair::Format::kRgb8:
      fillFromColors(row, gray, width, 0, 2);
      break;
    case Pair::Format::kBgr8:
      fillFromColors(row, gray, width, 2, 0);
      break;
  }
}

/// Bytes from row to row, also where the caller gives none.
std::ptrdiff_t strideOf(const Pair::Image& image) {
  return image.stride_bytes != 0 ? image.stride_bytes : image.width_px * bytesPerPixel(image.format);
}

/// 0 unless the samples have 16 bits.
int brightestOf(const Pair::Image& image) {
  if (image.format != Pair::Format::kGray16) return 0;
  std::uint16_t brightest = 0;
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += strideOf(image))
    for (int x = 0; x < image.width_px; ++x) brightest = std::max(brightest, sampleAt(row, x));
  return brightest;
}

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

/// Samples that eight bits hold may be those of a dark pair of a camera with more bits: a later pair will tell.
int SampleBits::of(const Pair& pair) {
  constexpr int kDark = 8;
  if (pair.left.format != Pair::Format::kGray16 && pair.right.format != Pair::Format::kGray16) return kAllSampleBits;
  if (const int decided = decided_.load(std::memory_order_relaxed); decided != 0) return decided;
  brightest_ = std::max(brightestOf(pair.left), brightestOf(pair.right));
  const int bits = usedSampleBits(0, brightest_);
  if (bits > kDark) decided_.store(bits, std::memory_order_release);
  return bits;
}

std::optional<std::string> SampleBits::news() {
  const int decided = decided_.load(std::memory_order_acquire);
  if (told_ || decided == 0) return std::nullopt;
  told_ = true;
  return "images of 16 bits, taken as " + std::to_string(decided) +
         ": the brightest sample of the first pair that is not dark is " + std::to_string(brightest_);
}

const char* problemOf(const Pair::Image& image, const Camera& camera) {
  if (image.pixels == nullptr) return "an image has no pixels";
  if (image.width_px != camera.width_px || image.height_px != camera.height_px)
    return "an image is not of the camera's size";
  const std::ptrdiff_t bytes = bytesPerPixel(image.format);
  if (bytes == 0) return "an image's format is none of those that there are";
  if (image.stride_bytes != 0 && image.stride_bytes < bytes * image.width_px)
    return "an image's stride is shorter than its rows";
  if (image.stride_bytes > kMostStride_bytes) return "an image's stride is above 2^24 bytes";
  return nullptr;
}

Image grayImage(const Pair::Image& image, int sample_bits, ImagePool& pool) {
  Image gray = pool.acquire(image.width_px, image.height_px);
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += strideOf(image))
    fillRow(row, image.format, sample_bits, gray.mutableRow(y), image.width_px);
  return gray;
}

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
