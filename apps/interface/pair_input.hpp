#pragma once

#include <memory>

#include "apps/interface/camera_model.hpp"
#include "core/image.hpp"
#include "core/instance_labels.hpp"
#include "core/messages.hpp"
#include "core/object_pool.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

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
