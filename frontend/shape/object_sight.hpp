#pragma once

#include <optional>
#include <span>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/dense_disparity.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// View of an object in a stereo pair.
struct Sight {
  LevelDisparities disparities;
  Outline outline;
  /// The outline by instance labels, with legs and wheels; empty where none agree.
  std::optional<Outline> labelled{};
  const Outline& mask() const { return labelled ? *labelled : outline; }
};

/// Looks densely at the window around an object. Keeps its buffers; one call at a time.
class ObjectSight {
 public:
  explicit ObjectSight(const StereoCamera& camera) : camera_(camera) {}

  /// The finest of so many levels of the pyramid at which the window has few cells.
  int levelOf(const ObjectView& view, int levels) const;
  /// Looks at `view.level`. Empty where nothing, or hardly anything, is seen of the object.
  std::optional<Sight> operator()(const ObjectView& view, const Features& features);

 private:
  std::optional<Box> usualBox(const ObjectView& view) const;
  std::optional<LevelDisparities> disparitiesAround(const ObjectView& view, const Features& features);
  static void refine(LevelDisparities& disparities, std::span<const int> cells, const Features& features);

  StereoCamera camera_;
  DenseDisparity dense_disparity_;
};

}  // namespace motorcade
