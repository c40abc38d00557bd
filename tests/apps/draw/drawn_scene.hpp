#pragma once

#include <algorithm>
#include <cstdint>

#include "apps/draw/views.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/images/image_file.hpp"

/// A small scene by hand, for tests of pictures.
namespace motorcade::test {

inline constexpr int kWidth_px = 400, kHeight_px = 120, kGray = 90;

inline Image grayImage() {
  ImagePool pool;
  Image image = pool.acquire(kWidth_px, kHeight_px);
  for (int y = 0; y < kHeight_px; ++y) std::fill_n(image.mutableRow(y), kWidth_px, std::uint8_t{kGray});
  return image;
}

/// Distance of a pixel's color from gray.
inline int colorfulness(const RgbImage& image, int x, int y) {
  const std::uint8_t* pixel = image.at(x, y);
  return std::max({pixel[0], pixel[1], pixel[2]}) - std::min({pixel[0], pixel[1], pixel[2]});
}

/// A car 12 m ahead that drives where the camera looks, 4 x 2 x 1.5 m, its body frame in its middle.
inline ObjectEstimate carAhead() {
  Eigen::Matrix3d world_body;
  world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  ObjectEstimate car;
  car.track = {1};
  car.T_world_body = SE3(world_body, {0, 0.75, 12});
  car.box = {170, 55, 230, 105};
  car.cuboid = ObjectBox{};
  car.cuboid->size_m = {4, 2, 1.5};
  car.cuboid->kind = ObjectKind::kCar;
  return car;
}

inline RecordedDrive driveWith(const ObjectEstimate& object) {
  RecordedDrive drive;
  drive.name = "drive";
  drive.camera = {300, 300, 200, 60, 0.5, kWidth_px, kHeight_px};
  drive.stamps = {Timestamp{0}};
  drive.T_world_cam = {SE3()};
  drive.objects[0] = {object};
  return drive;
}

/// The left image with what is painted onto it.
inline RgbImage drawImageView(const DrawnImages& images, const RecordedDrive& drive, std::size_t frame) {
  Canvas canvas(images.left);
  Marks marks;
  Sheet sheet{canvas, marks};
  paintImageView(sheet, images, drive, frame);
  return canvas.image();
}

/// A label in frame 0 of KITTI's box frame: x along the length, which is across the road here, y down.
inline ObjectTruth labelAt(std::int64_t id, double right_m, double ahead_m) {
  ObjectTruth truth;
  truth.id = id;
  truth.T_world_object = SE3(Eigen::Matrix3d::Identity(), {right_m, 1.5, ahead_m});
  truth.size_m = {1.5, 1.8, 4};
  return truth;
}

/// A point of track 1 where the camera sees it.
inline ObjectPoint pointAt(const RecordedDrive& drive, std::int64_t id, const Eigen::Vector3d& p_cam) {
  const auto uvd_px = drive.camera.project(p_cam);
  return {.frame = {0}, .track = {1}, .point = {id}, .uvd_px = uvd_px.value_or(Eigen::Vector3d::Zero())};
}

}  // namespace motorcade::test
