#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "apps/interface/camera_model.hpp"
#include "core/image.hpp"
#include "core/instance_labels.hpp"
#include "core/messages.hpp"
#include "core/object_pool.hpp"
#include "core/vehicle_motion.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The farthest stamp on either side of zero. Differences of two stamps do not overflow.
inline constexpr std::int64_t kFarthestStamp_ns = std::int64_t{1} << 62;

/// The reason why a sample cannot be used, as static text; null where it can.
const char* problemOf(const VehicleMotion& motion);

VehicleMotionSample sampleOf(const VehicleMotion& motion);

/// The longest stride that is accepted: a longer one is a mistake.
inline constexpr std::ptrdiff_t kMostStride_bytes = 1 << 24;

/// Reason why an image cannot be one of this camera; null when it can.
const char* problemOf(const Pair::Image& image, const Camera& camera);

/// Finds the number of bits that 16-bit samples use, as cameras have ten, twelve or fourteen. Call it for each pair in
/// turn. The first pair that is not dark decides for all that follow.
class SampleBits {
 public:
  /// The bits of this pair's samples, the same for both images. The pair has no problem.
  int of(const Pair& pair);
  /// Returns the finding once, as a sentence. Call it where results are delivered, so that a push writes no text.
  std::optional<std::string> news();

 private:
  int brightest_ = 0;
  std::atomic<int> decided_{0};  // 0 until it is known; published after `brightest_`, which stays from then on
  bool told_ = false;            // the delivering thread's
};

/// The image as 8-bit gray in a buffer of the pool: the one copy between the caller and the stages. Of 16-bit samples
/// the upper eight of `sample_bits` are used.
Image grayImage(const Pair::Image& image, int sample_bits, ImagePool& pool);

/// Makes a frame of a caller's pair: checks it, copies its pixels once into pooled memory, and rectifies it. One thread
/// hands pairs in. Under the live policy it does not allocate, but for the labels' room with the first ones.
class PairInput {
 public:
  /// `model` is of the camera, and outlives it.
  PairInput(const Camera& camera, const CameraModel& model, Tracker::Policy policy);

  /// The reason why a pair cannot be taken, as static text; null where it can.
  const char* problemWith(const Pair& pair) const;
  /// Takes a pair without a problem. Throws std::bad_alloc.
  StereoFrame frameOf(const Pair& pair, int sample_bits);

 private:
  std::shared_ptr<const InstanceLabels> labelsOf(const Pair::Image& given);
  void stockLabels();

  Camera camera_;
  const CameraModel& model_;
  bool stocked_labels_;  // or none are to be
  ImagePool images_;
  ObjectPool<InstanceLabels> labels_;
};

}  // namespace motorcade
