#include <gmock/gmock.h>

#include "apps/draw/draw_command.hpp"
#include "apps/draw/frame_view.hpp"
#include "io/errors.hpp"
#include "io/run_folder.hpp"
#include "io/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

int differingPixels(const Canvas& a, const Canvas& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.image().pixels.size(); i += 3) count += a.image().pixels[i] != b.image().pixels[i];
  return count;
}

TEST(Canvas, ALineCoversItsWidthTimesItsLength) {
  const Canvas empty(60, 40, {0, 0, 0});
  Canvas canvas = empty;
  canvas.line({10, 20}, {50, 20}, {200, 0, 0}, 3);
  double sum = 0;
  for (std::size_t i = 0; i < canvas.image().pixels.size(); i += 3) sum += canvas.image().pixels[i] / 200.0;
  EXPECT_NEAR(sum, 3 * 40 + 7, 4) << "with its two round ends";
}

TEST(Canvas, APolygonCoversItsAreaWhicheverWayItTurns) {
  for (const bool turned : {false, true}) {
    Canvas canvas(60, 40, {0, 0, 0});
    std::vector<Eigen::Vector2d> corners{{10, 10}, {40, 10}, {40, 30}, {10, 30}};
    if (turned) std::reverse(corners.begin(), corners.end());
    canvas.fillPolygon(corners, {200, 0, 0});
    double sum = 0;
    for (std::size_t i = 0; i < canvas.image().pixels.size(); i += 3) sum += canvas.image().pixels[i] / 200.0;
    EXPECT_NEAR(sum, 30 * 20, 5);  // anti-aliasing takes a little off the corners
  }
}

TEST(Canvas, ShapesOutsideOrWithoutAPlaceAreCut) {
  const Canvas empty(30, 20, {9, 9, 9});
  Canvas canvas = empty;
  const double none = std::numeric_limits<double>::quiet_NaN();
  canvas.line({-100, -100}, {-5, -90}, {255, 0, 0}, 3);
  canvas.line({none, 0}, {5, 5}, {255, 0, 0}, 3);
  canvas.fillPolygon({{100, 100}, {120, 100}, {110, 130}}, {255, 0, 0});
  canvas.text({-200, 5}, "off", {255, 0, 0});
  canvas.text({1e9, 5}, "off", {255, 0, 0});
  EXPECT_EQ(differingPixels(canvas, empty), 0);
  canvas.line({-1e9, 10}, {1e9, 10}, {255, 0, 0}, 1);
  EXPECT_GE(differingPixels(canvas, empty), 30);
}

TEST(Canvas, EveryLetterOfTheLabelsHasAShape) {
  const Canvas empty(30, 30, {0, 0, 0});
  for (const char letter : std::string_view("0123456789#./-:abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")) {
    Canvas canvas = empty;
    canvas.text({2, 2}, std::string_view(&letter, 1), {255, 255, 255});
    EXPECT_GT(differingPixels(canvas, empty), 0) << letter;
  }
}

TEST(Draw, MakesAPictureOfEveryNthFrameOfTheRun) {
  const test::TemporaryFolder folder;
  ImagePool pool;
  Image image = pool.acquire(400, 120);
  for (int y = 0; y < 120; ++y) std::fill_n(image.mutableRow(y), 400, std::uint8_t{90});
  std::string poses;
  for (const char* side : {"drive/left", "drive/right"}) std::filesystem::create_directories(folder / side);
  for (int i = 0; i < 8; ++i) {
    for (const char* side : {"drive/left", "drive/right"})
      writePng(folder / side / (std::to_string(i) + ".png"), image);
    poses += kittiLine(SE3(Eigen::Matrix3d::Identity(), {0, 0, static_cast<double>(i)})) + "\n";
  }
  folder.write("drive/calib.txt", "P0: 300 0 200 0 0 300 60 0 0 0 1 0\nP1: 300 0 200 -150 0 300 60 0 0 0 1 0\n");
  folder.write("drive/poses.txt", poses);
  folder.write("drive/label_02.txt", "4 1 Car 0 0 0 10 10 40 60 1.5 1.7 4.2 0 1.6 12 -1.57\n");
  {
    RunFolderWriter writer(folder / "run");
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
      writer.writeOnline(estimate);
      writer.writeTiming(timing);
      writer.writeFinal(estimate);
    }
  }
  testing::internal::CaptureStdout();
  EXPECT_EQ(runDraw({.run = folder / "run",
                     .sequence = folder / "drive",
                     .out = folder / "pictures",
                     .frames = {3, 8},
                     .every = 2}),
            0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("3 pictures"));
  for (const char* name : {"frame_000003.png", "frame_000005.png", "frame_000007.png"}) {
    EXPECT_EQ(readImageSize(folder / "pictures" / name), (ImageSize{400, 120 + 4 + 240}));
  }
  EXPECT_NE(readImage(folder / "pictures/frame_000005.png", pool).at(200, 50), 90) << "the object's box";
  folder.write("file", "");
  EXPECT_THROW(runDraw({.run = folder / "run", .sequence = folder / "drive", .out = folder / "file"}), OutputError);
}

}  // namespace
}  // namespace motorcade
