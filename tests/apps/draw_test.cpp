#include <gmock/gmock.h>

#include "apps/draw/draw_command.hpp"
#include "apps/draw/image_view.hpp"
#include "apps/draw/top_view.hpp"
#include "io/errors.hpp"
#include "io/mask_image.hpp"
#include "io/run_folder.hpp"
#include "io/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

constexpr int kWidth_px = 400, kHeight_px = 120, kGray = 90;

Image grayImage() {
  static ImagePool pool;
  Image image = pool.acquire(kWidth_px, kHeight_px);
  for (int y = 0; y < kHeight_px; ++y) std::fill_n(image.mutableRow(y), kWidth_px, std::uint8_t{kGray});
  return image;
}

/// How far a pixel is from gray.
int colorfulness(const Canvas& canvas, int x, int y) {
  const std::uint8_t* pixel = canvas.image().at(x, y);
  return std::max({pixel[0], pixel[1], pixel[2]}) - std::min({pixel[0], pixel[1], pixel[2]});
}

int colorfulPixels(const Canvas& canvas) {
  int count = 0;
  for (int y = 0; y < canvas.height(); ++y)
    for (int x = 0; x < canvas.width(); ++x) count += colorfulness(canvas, x, y) > 20;
  return count;
}

/// A car 12 m ahead that drives where the camera looks, 4 x 2 x 1.5 m, its body frame in its middle.
ObjectEstimate carAhead() {
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

RecordedDrive runWith(const ObjectEstimate& object) {
  RecordedDrive run;
  run.camera = {300, 300, 200, 60, 0.5, kWidth_px, kHeight_px};
  run.stamps = {Timestamp{0}};
  run.T_world_cam = {SE3()};
  run.objects[0] = {object};
  return run;
}

TEST(ImageView, ShowsTheCuboidsEdgesWhereTheyProject) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  const Canvas canvas = drawImageView({grayImage()}, runWith(car), 0);
  // The near face is 10 m away: 60 px wide and 45 px high around (200, 60 + 22.5), the far one 14 m.
  for (const auto& [x, y] : {std::pair(170, 82), std::pair(230, 82), std::pair(200, 105)})
    EXPECT_GT(colorfulness(canvas, x, y), 100) << x << ", " << y;
  EXPECT_GT(colorfulness(canvas, 179, 82), 20) << "hidden, but there";
  EXPECT_LT(colorfulness(canvas, 179, 82), colorfulness(canvas, 170, 82));
  EXPECT_EQ(colorfulness(canvas, 190, 97), 0) << "nothing lies between the edges";
}

TEST(ImageView, CutsACuboidThatReachesBehindTheCamera) {
  ObjectEstimate car = carAhead();
  car.T_world_body = SE3(car.T_world_body.rotation(), {2.5, 0.75, 1.5});  // beside the camera, from -.5 to 3.5 m
  const Canvas canvas = drawImageView({grayImage()}, runWith(car), 0);
  EXPECT_GT(colorfulness(canvas, 329, 82), 100) << "the far face's left edge, 1.5 m right and 3.5 m ahead";
}

TEST(ImageView, TintsTheMaskAndMarksPoints) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  RecordedDrive run = runWith(car);
  DrawnImages images{.left = grayImage(), .mask = Gray16Image{.width = kWidth_px, .height = kHeight_px, .pixels = {}}};
  images.mask->pixels.assign(std::size_t{kWidth_px} * kHeight_px, 0);
  for (int y = 90; y < 100; ++y)
    for (int x = 185; x < 198; ++x) images.mask->pixels[y * kWidth_px + x] = 2;  // track 1
  run.points[0] = {{.frame = {0}, .track = {1}, .point = {}, .uvd_px = {215, 95, 12}}};
  const Canvas canvas = drawImageView(images, run, 0);
  EXPECT_GT(colorfulness(canvas, 190, 94), 30);
  EXPECT_LT(colorfulness(canvas, 190, 94), 100) << "translucent";
  EXPECT_GT(colorfulness(canvas, 190, 90), 100) << "the rim";
  EXPECT_EQ(colorfulness(canvas, 202, 94), 0);
  EXPECT_GT(colorfulness(canvas, 215, 95), 30) << "the point";
}

TEST(ImageView, TagsOfObjectsInOneDirectionStandOneAboveTheOther) {
  ObjectEstimate car = carAhead(), behind = carAhead();
  behind.track = {2};
  const auto tagged = [](const std::vector<ObjectEstimate>& objects) {
    RecordedDrive run = runWith(objects.front());
    run.objects[0] = objects;
    const Canvas canvas = drawImageView({grayImage()}, run, 0);
    int count = 0;  // of the plates' pixels above the boxes
    for (int y = 0; y < 55; ++y)
      for (int x = 0; x < kWidth_px; ++x) count += colorfulness(canvas, x, y) > 100;
    return count;
  };
  EXPECT_GT(tagged({car, behind}), 1.8 * tagged({car}));
}

TEST(TopView, ShowsTheFootprintAndWhereItMayBe) {
  ObjectEstimate car = carAhead();
  car.state = ObjectState::kStopped;
  const Canvas sure = drawTopView(runWith(car), 0, 950, 400);
  // Ten pixels per meter; the camera is at (247, 200).
  EXPECT_GT(colorfulness(sure, 247 + 105, 200), 100) << "its rear";
  constexpr int kField = 20;  // of the camera's field of view
  EXPECT_LE(colorfulness(sure, 247 + 120, 200 + 14), kField);
  car.covariance = Matrix6d::Identity() * 1e-4;
  car.cuboid->size_sigma_m = {0.1, 0.8, 0.1};
  const Canvas unsure = drawTopView(runWith(car), 0, 950, 400);
  EXPECT_GT(colorfulness(unsure, 247 + 120, 200 + 14), kField + 10) << "within two sigma of a width of 2 +- .8 m";
  EXPECT_LT(colorfulness(unsure, 247 + 120, 200 + 14), 60);
  EXPECT_LE(colorfulness(unsure, 247 + 120, 200 - 20), kField) << "beyond";
}

TEST(TopView, ShowsPointsAtTheirDepthAndMotionAheadOfTheNose) {
  ObjectEstimate car = carAhead();
  RecordedDrive run = runWith(car);
  const int still = colorfulPixels(drawTopView(run, 0, 950, 400));
  run.objects[0][0].velocity_world_mps = {0, 0, 6};
  const Canvas moving = drawTopView(run, 0, 950, 400);
  EXPECT_GT(colorfulPixels(moving), still);
  EXPECT_GT(colorfulness(moving, 247 + 170, 200), 100) << "3 m ahead of the nose";
  run.points[0] = {{.frame = {0}, .track = {1}, .point = {}, .uvd_px = {200, 70, 6}}};  // 25 m ahead
  const Canvas pointed = drawTopView(run, 0, 950, 400);
  EXPECT_GT(pointed.image().at(247 + 250, 200)[0], 150);
  EXPECT_LT(moving.image().at(247 + 250, 200)[0], 60);
}

/// A drive of eight frames, and a run of all but its first two.
class DrawnDrive : public testing::Test {
 protected:
  DrawnDrive() {
    writeDrive();
    RunFolderWriter writer(folder_ / "run");
    for (int i = 2; i < 8; ++i) {
      FrameEstimate estimate;
      estimate.frame = {i};
      estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, i - 2.0});
      ObjectEstimate object;
      object.track = {1};
      object.T_world_body = SE3(Eigen::Matrix3d::Identity(), {1, 1, 12 + 1.5 * i});
      object.velocity_world_mps = {0, 0, 15};
      object.box = {180, 50, 230, 90};
      estimate.objects.push_back(object);
      FrameTiming timing;
      timing.frame = estimate.frame;
      timing.stamp = {i * 100'000'000LL};
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

  /// Frames 3, 5 and 7; gives what is printed.
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
  for (const char* name : {"frame_000003.png", "frame_000005.png", "frame_000007.png"})
    EXPECT_EQ(readImageSize(folder_ / "pictures" / name), (ImageSize{400, 120 + 4 + 240}));
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

}  // namespace
}  // namespace motorcade
