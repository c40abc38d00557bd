#include <cstdlib>

#include <gmock/gmock.h>

#include "apps/draw/draw_command.hpp"
#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"
#include "io/results/run_folder.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/apps/draw/drawn_scene.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::grayImage;
using test::kGray;
using test::kHeight_px;
using test::kWidth_px;

/// A drive of eight frames, and a run of all but its first two.
class DrawnDrive : public testing::Test {
 protected:
  DrawnDrive() {
    writeDrive();
    RunFolderWriter writer(folder_ / "run");
    for (int i = 2; i < 8; ++i) {
      FrameEstimate estimate;
      estimate.head.frame = {i};
      estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, i - 2.0});
      ObjectEstimate object;
      object.track = {1};
      object.T_world_body = SE3(Eigen::Matrix3d::Identity(), {1, 1, 12 + 1.5 * i});
      object.velocity_world_mps = {0, 0, 15};
      object.box = {180, 50, 230, 90};
      estimate.objects.push_back(object);
      FrameTiming timing;
      timing.head.frame = estimate.head.frame;
      timing.head.stamp = {i * 100'000'000LL};
      writer.writeOnline(estimate);
      writer.writeTiming(timing);
      writer.writeFinal(estimate);
    }
  }

  void writeDrive() const {
    std::string poses;
    for (const char* side : {"drive/left", "drive/right"}) std::filesystem::create_directories(folder_ / side);
    for (int i = 0; i < 8; ++i) {
      for (const char* side : {"drive/left", "drive/right"})
        writePng(folder_ / side / (std::to_string(i) + ".png"), grayImage());
      poses += kittiLine(SE3(Eigen::Matrix3d::Identity(), {0, 0, static_cast<double>(i)})) + "\n";
    }
    folder_.write("drive/calib.txt", "P0: 300 0 200 0 0 300 60 0 0 0 1 0\nP1: 300 0 200 -150 0 300 60 0 0 0 1 0\n");
    folder_.write("drive/poses.txt", poses);
    folder_.write("drive/label_02.txt", "4 1 Car 0 0 0 10 10 40 60 1.5 1.7 4.2 0 1.6 12 -1.57\n");
  }

  /// A mask of track 1 alone.
  void writeMask(int frame, int width_px) const {
    Gray16Image mask{.width = width_px, .height = kHeight_px, .pixels = {}};
    mask.pixels.assign(static_cast<std::size_t>(width_px) * kHeight_px, 2);
    std::filesystem::create_directories(folder_ / "run/masks");
    writePng16(maskFile(folder_ / "run/masks", {frame}), mask);
  }

  /// Draws frames 3, 5 and 7; returns what is printed.
  std::string draw() const {
    testing::internal::CaptureStdout();
    EXPECT_EQ(runDraw({.run = folder_ / "run",
                       .sequence = folder_ / "drive",
                       .out = folder_ / "pictures",
                       .frames = {3, 8},
                       .every = 2}),
              0);
    return testing::internal::GetCapturedStdout();
  }
  Image picture(const std::string& name) {
    ImagePool pool;
    return readImage(folder_ / "pictures" / name, pool);
  }

  test::TemporaryFolder folder_;
};

TEST_F(DrawnDrive, MakesAPictureOfEveryNthFrameOfTheRun) {
  EXPECT_THAT(draw(), testing::HasSubstr("3 pictures"));
  const ImageSize size = readImageSize(folder_ / "pictures/frame_000003.png");
  EXPECT_EQ(size.width, kWidth_px);
  EXPECT_GT(size.height, 2 * kHeight_px);
  for (const char* name : {"frame_000003.png", "frame_000005.png", "frame_000007.png"})
    EXPECT_EQ(readImageSize(folder_ / "pictures" / name), size);
  EXPECT_NE(picture("frame_000005.png").at(200, 50), kGray) << "the object's box";
  folder_.write("file", "");
  EXPECT_THROW(runDraw({.run = folder_ / "run", .sequence = folder_ / "drive", .out = folder_ / "file"}), OutputError);
}

TEST_F(DrawnDrive, TakesTheSequenceFromTheRunAndNoOther) {
  const DrawOptions options{.run = folder_ / "run", .out = folder_ / "pictures"};
  EXPECT_THAT(test::messageOf<InputError>([&] { runDraw(options); }), testing::HasSubstr("summary.json"));
  folder_.write("run/summary.json", R"({"sequence": ")" + (folder_ / "drive").string() + "\"}");
  testing::internal::CaptureStdout();
  EXPECT_EQ(runDraw(options), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("6 pictures"));
  for (const char* side : {"drive/left", "drive/right"}) std::filesystem::remove(folder_ / side / "7.png");
  EXPECT_THAT(test::messageOf<InputError>([&] { runDraw(options); }), testing::HasSubstr("is no run of"));
}

TEST_F(DrawnDrive, ShowsMasksAndPointsWhereTheRunWroteThem) {
  writeMask(7, kWidth_px);
  folder_.write("run/object_points.csv", "frame,track_id,point_id,u,v,disparity\n5,1,9,100.000,30.000,8.000\n");
  draw();
  EXPECT_NE(picture("frame_000005.png").at(100, 30), kGray) << "the point";
  EXPECT_EQ(picture("frame_000005.png").at(20, 20), kGray);
  EXPECT_NE(picture("frame_000007.png").at(20, 20), kGray) << "the mask";
  EXPECT_EQ(picture("frame_000003.png").at(100, 30), kGray) << "a frame without";
}

TEST_F(DrawnDrive, LeavesAFrameOutWhoseMaskDoesNotFit) {
  writeMask(5, kWidth_px - 1);
  testing::internal::CaptureStderr();
  EXPECT_THAT(draw(), testing::HasSubstr("2 pictures"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::AllOf(testing::HasSubstr("000005.png"), testing::HasSubstr("399x120")));
}

TEST_F(DrawnDrive, WithoutFfmpegTheVideosPicturesGoIntoAFolder) {
  const char* const before = std::getenv("PATH");
  const std::string kept = before ? before : "";
  ::setenv("PATH", folder_.path().c_str(), 1);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const DrawOptions options{
      .run = folder_ / "run", .sequence = folder_ / "drive", .video = folder_ / "street.mp4", .every = 3};
  EXPECT_EQ(runDraw(options), 0);
  ::setenv("PATH", kept.c_str(), 1);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("2 pictures"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::AllOf(testing::HasSubstr("no ffmpeg"), testing::HasSubstr("street.mp4")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "street/frame_000003.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "street.mp4"));
}

TEST_F(DrawnDrive, NeedsAPlaceForItsPictures) {
  EXPECT_THAT(test::messageOf<UsageError>([&] { runDraw({.run = folder_ / "run"}); }), testing::HasSubstr("--video"));
  EXPECT_THAT(test::messageOf<UsageError>([&] {
                runDraw({.run = folder_ / "run", .sequence = folder_ / "drive", .video = folder_ / "street.gif"});
              }),
              testing::HasSubstr("street.gif"));
}

}  // namespace
}  // namespace motorcade
