#include "apps/export/export_command.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

/// Five frames; the third was lost; the object is predicted in the last.
RunFolder runByHand() {
  RunFolder run{.first_frame = 10};
  for (int i = 0; i < 5; ++i) {
    run.frames.push_back({.head = {.frame = {10 + i},
                                   .stamp = {1'700'000'000'000'000'001 + std::int64_t{100'000'000} * i},
                                   .status = i == 2 ? FrameStatus::kLost : FrameStatus::kGood}});
    run.final.camera.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, i));
    ObjectEstimate object;
    object.track = {7};
    object.state = i == 4 ? ObjectState::kPredicted : ObjectState::kMoving;
    object.T_world_body = SE3(Eigen::Matrix3d::Identity(), {1, 0, 10.0 + i});
    if (i > 0) run.final.objects.push_back({{10 + i}, object});
  }
  return run;
}

TEST(TumExport, WritesMeasuredPosesOfCameraAndObjects) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(exportTum(runByHand(), folder / "tum", false), 1U);
  const std::string pose = " 0.000000000 0.000000000 0.000000000 1.000000000\n";
  EXPECT_EQ(folder.read("tum/camera.tum"), "1700000000.000000001 0.000000000 0.000000000 0.000000000" + pose +
                                               "1700000000.100000001 0.000000000 0.000000000 1.000000000" + pose +
                                               "1700000000.300000001 0.000000000 0.000000000 3.000000000" + pose +
                                               "1700000000.400000001 0.000000000 0.000000000 4.000000000" + pose);
  EXPECT_EQ(folder.read("tum/object_007.tum"), "1700000000.100000001 1.000000000 0.000000000 11.000000000" + pose +
                                                   "1700000000.200000001 1.000000000 0.000000000 12.000000000" + pose +
                                                   "1700000000.300000001 1.000000000 0.000000000 13.000000000" + pose);
}

TEST(TumExport, PredictedPosesComeWhenTheyAreAskedFor) {
  const test::TemporaryFolder folder;
  exportTum(runByHand(), folder.path(), true);
  for (const char* file : {"camera.tum", "object_007.tum"}) {
    const std::string lines = folder.read(file);
    EXPECT_EQ(std::ranges::count(lines, '\n'), file[0] == 'c' ? 5 : 4) << file;
  }
}

std::string refusalOf(const ExportOptions& options) {
  return test::messageOf<UsageError>([&] { runExport(options); });
}

TEST(ExportCommand, TellsWhatToWrite) {
  EXPECT_THAT(refusalOf({.run = "run"}), testing::HasSubstr("--mcap FILE, --osi FILE, --tum DIR"));
}

TEST(ExportCommand, AMountingIsForOsiAlone) {
  EXPECT_THAT(refusalOf({.run = "run", .mounting = "1,0,1,0,0,0", .tum = "tum"}), testing::HasSubstr("--osi FILE"));
  EXPECT_THAT(refusalOf({.run = "run", .osi = "trace.mcap", .mounting = "1,0,1"}),
              testing::HasSubstr("write X,Y,Z,ROLL,PITCH,YAW"));
}

}  // namespace
}  // namespace motorcade
