#pragma once

#include <optional>
#include <span>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/dense_disparity.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// True when the image's border cuts off an object with these points. At the left, so does the border of what the right
/// camera sees.
bool isCutOff(const Box& points, const SE3& T_cam_body, const StereoCamera& camera);

/// Share of a cuboid's width that both cameras see.
double shareInImages(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera);

/// Drops rows of objects that have left the images. A predicted one has left when less than half of it is seen. One
/// that still has points has left when nothing of its cuboid is seen: then the points are those of another vehicle.
void dropLeft(FrameEstimate& frame, const StereoCamera& camera);

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
