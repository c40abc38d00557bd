#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <png.h>

#include "io/images/image_file.hpp"
#include "io/images/mask_image.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

/// Lays a drive with exact truth out as a variation of Virtual KITTI 2.
namespace motorcade::test {

namespace fs = std::filesystem;

/// An indexed PNG of 8 bits, as instance masks are.
inline void writeIndexedPng(const fs::path& file, int width, int height, const std::vector<std::uint8_t>& indices) {
  std::FILE* const out = std::fopen(file.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_PALETTE,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette(256);
  for (std::size_t i = 0; i < palette.size(); ++i)
    palette[i] = {static_cast<png_byte>(37 * i), static_cast<png_byte>(91 * i), static_cast<png_byte>(255 - i)};
  png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_write_info(png, info);
  for (int y = 0; y < height; ++y) png_write_row(png, &indices[static_cast<std::size_t>(y) * width]);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
}

/// Angles about y, x and z of a rotation that turns about z first, then x, then y.
inline Eigen::Vector3d anglesYxz(const Eigen::Matrix3d& R) {
  return {std::atan2(R(0, 2), R(2, 2)), -std::asin(R(1, 2)), std::atan2(R(1, 0), R(1, 1))};
}

/// The drive that `writeVirtualKitti` writes.
struct VirtualKittiDrive {
  Sequence sequence;
  CameraTruth camera;
  ObjectTruths objects;
  SE3 T_map_world{};  // the data set's own world is anywhere
  int digits = 12;

  void write(const fs::path& variation) const {
    for (const char* const name :
         {"frames/rgb/Camera_0", "frames/rgb/Camera_1", "frames/instanceSegmentation/Camera_0"})
      fs::create_directories(variation / name);
    std::ofstream(variation / "intrinsic.txt") << intrinsics();
    std::ofstream(variation / "extrinsic.txt") << extrinsics();
    std::ofstream(variation / "info.txt") << information();
    std::ofstream boxes(variation / "bbox.txt"), poses(variation / "pose.txt");
    boxes << std::setprecision(digits)
          << "frame cameraID trackID left right top bottom number_pixels truncation_ratio occupancy_ratio isMoving\n";
    poses << std::setprecision(digits)
          << "frame cameraID trackID alpha width height length world_space_X world_space_Y world_space_Z "
             "rotation_world_space_y rotation_world_space_x rotation_world_space_z camera_space_X camera_space_Y "
             "camera_space_Z rotation_camera_space_y rotation_camera_space_x rotation_camera_space_z\n";
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      linkImage(sequence.frames[i].left, variation / "frames/rgb/Camera_0" / named("rgb_", i, ".jpg"));
      linkImage(sequence.frames[i].right, variation / "frames/rgb/Camera_1" / named("rgb_", i, ".jpg"));
      const auto pixels = writeInstances(i, variation / "frames/instanceSegmentation/Camera_0");
      for (const ObjectTruth& object : objects.objects)
        if (object.frame.value == static_cast<std::int64_t>(i)) writeObject(object, pixels, boxes, poses);
    }
  }

 private:
  static std::string named(const std::string& before, std::size_t number, const std::string& behind) {
    std::ostringstream name;
    name << before << std::setw(5) << std::setfill('0') << number << behind;
    return name.str();
  }
  /// Readers tell images by their content, whatever their names end with.
  static void linkImage(const fs::path& image, const fs::path& link) { fs::create_symlink(fs::absolute(image), link); }

  std::string intrinsics() const {
    std::ostringstream text;
    text << std::setprecision(digits) << "frame cameraID K[0,0] K[1,1] K[0,2] K[1,2]\n";
    for (std::size_t i = 0; i < sequence.frames.size(); ++i)
      for (const int side : {0, 1})
        text << i << ' ' << side << ' ' << sequence.camera.fx_px << ' ' << sequence.camera.fy_px << ' '
             << sequence.camera.cx_px << ' ' << sequence.camera.cy_px << '\n';
    return text.str();
  }

  std::string extrinsics() const {
    std::ostringstream text;
    text << std::setprecision(digits)
         << "frame cameraID r1,1 r1,2 r1,3 t1 r2,1 r2,2 r2,3 t2 r3,1 r3,2 r3,3 t3 0 0 0 1\n";
    for (std::size_t i = 0; i < sequence.frames.size(); ++i)
      for (const int side : {0, 1}) {
        const SE3 T_left_cam(Eigen::Matrix3d::Identity(), {side * sequence.camera.baseline_m, 0, 0});
        const SE3 T_cam_map = (T_map_world * camera.T_world_cam[i] * T_left_cam).inverse();
        text << i << ' ' << side;
        for (int row = 0; row < 3; ++row) {
          for (int column = 0; column < 3; ++column) text << ' ' << T_cam_map.rotation()(row, column);
          text << ' ' << T_cam_map.translation()[row];
        }
        text << " 0 0 0 1\n";
      }
    return text.str();
  }

  std::string information() const {
    std::map<std::int64_t, std::string> types;
    for (const ObjectTruth& object : objects.objects) types[object.id] = object.type;
    std::string text = "trackID label model color\n";
    for (const auto& [id, type] : types) text += std::to_string(id) + " " + type + " Hatchback Red\n";
    return text;
  }

  /// Writes the masks, and returns the number of pixels of each object.
  std::map<std::int64_t, int> writeInstances(std::size_t frame, const fs::path& folder) const {
    std::map<std::int64_t, int> pixels;
    if (sequence.truth.instances.empty()) return pixels;
    const Gray16Image mask = readPng16(maskFile(sequence.truth.instances, FrameId{static_cast<std::int64_t>(frame)}));
    for (const std::uint16_t value : mask.pixels)
      if (value > 0) ++pixels[value - 1];
    const std::vector<std::uint8_t> indices(mask.pixels.begin(), mask.pixels.end());
    writeIndexedPng(folder / named("instancegt_", frame, ".png"), mask.width, mask.height, indices);
    return pixels;
  }

  void writeObject(const ObjectTruth& object, const std::map<std::int64_t, int>& pixels, std::ostream& boxes,
                   std::ostream& poses) const {
    const auto seen = pixels.find(object.id);
    const double count = seen == pixels.end() ? 0 : seen->second;
    const Box& box = object.box;
    const double area = (box.right_px - box.left_px) * (box.bottom_px - box.top_px);
    boxes << object.frame.value << " 0 " << object.id << ' ' << box.left_px << ' ' << box.right_px << ' ' << box.top_px
          << ' ' << box.bottom_px << ' ' << count << ' ' << object.truncated << ' ' << count / area << " True\n";
    const SE3 T_map_object = T_map_world * object.T_world_object;
    const Eigen::Vector3d &p_cam = object.T_cam_object.translation(), &p_map = T_map_object.translation();
    const Eigen::Vector3d in_cam = anglesYxz(object.T_cam_object.rotation()),
                          in_map = anglesYxz(T_map_object.rotation());
    for (const int side : {0, 1}) {
      const double x_m = p_cam.x() - side * sequence.camera.baseline_m;
      poses << object.frame.value << ' ' << side << ' ' << object.id << ' ' << in_cam[0] - std::atan2(x_m, p_cam.z())
            << ' ' << object.size_m[1] << ' ' << object.size_m[0] << ' ' << object.size_m[2] << ' ' << p_map.x() << ' '
            << p_map.y() << ' ' << p_map.z() << ' ' << in_map[0] << ' ' << in_map[1] << ' ' << in_map[2] << ' ' << x_m
            << ' ' << p_cam.y() << ' ' << p_cam.z() << ' ' << in_cam[0] << ' ' << in_cam[1] << ' ' << in_cam[2] << '\n';
    }
  }
};

/// A drive whose truth is read from its folder; empty where it has none.
inline std::optional<VirtualKittiDrive> virtualKittiDriveOf(const fs::path& folder) {
  const Sequence sequence = openSequence(folder);
  auto camera = readCameraTruth(sequence);
  if (!camera) return std::nullopt;
  auto objects = readObjectTruths(sequence, *camera);
  if (!objects) return std::nullopt;
  return VirtualKittiDrive{.sequence = sequence, .camera = *camera, .objects = *objects};
}

}  // namespace motorcade::test
