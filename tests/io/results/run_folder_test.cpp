#include "io/results/run_folder.hpp"

#include <csignal>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "io/files/errors.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

FrameEstimate estimateOf(int i) {
  FrameEstimate estimate;
  estimate.head.frame = {i};
  estimate.head.stamp = {1'317'042'651'174'740'992 + i * 100'000'000LL};
  estimate.T_world_cam = SE3::exp((Vector6d() << 0.1 * i, 0.02, 1.2 * i, 0.001 * i, 0.01 * i, 0).finished());
  ObjectEstimate object;
  object.track = {4};
  object.state = i == 2 ? ObjectState::kPredicted : ObjectState::kMoving;
  object.T_world_body = SE3::exp((Vector6d() << 3, 1, 20 + i, 0, 1, 0).finished());
  object.velocity_world_mps = {0.5, 0, 10};
  object.speed_sigma_mps = 0.25;
  object.yaw_rate_radps = -0.125;
  object.yaw_rate_sigma_radps = 0.03125;
  object.points = 17;
  object.box = {10, 20, 110.5, 90.25};
  object.covariance = Matrix6d::Identity() * 0.01;
  ObjectBox cuboid;
  cuboid.center_body = {1.5, 0.25, -0.125};
  cuboid.size_m = {4, 1.75, 1.5};
  cuboid.size_sigma_m = {0.5, 0.1, 0.1};
  cuboid.kind = ObjectKind::kTwoWheeler;
  cuboid.kind_probability = 0.75;
  object.age_s = 0.1 * i;
  object.existence_probability = 0.875;
  if (i != 1)
    object.acceleration = {.along_mps2 = -2.5, .along_sigma_mps2 = 0.5, .yaw_radps2 = 0.25, .yaw_sigma_radps2 = 0.125};
  if (i != 2) object.cuboid = cuboid;
  estimate.objects.push_back(object);
  estimate.camera_covariances = {.motion = Matrix6d::Identity() * 0.02, .pose = Matrix6d::Identity() * (i + 1)};
  return estimate;
}

FrameTiming timingOfEstimate(int i) {
  FrameTiming timing;
  timing.head.frame = {i};
  timing.head.stamp = estimateOf(i).head.stamp;
  timing.due = SteadyTime(std::chrono::milliseconds(1000 + 100 * i));
  timing.published = timing.due + std::chrono::microseconds(30500);
  timing.stages[0] = {timing.due, timing.due + std::chrono::milliseconds(3), 1};
  return timing;
}

void writeRun(const std::filesystem::path& folder, int first, int count) {
  RunFolderWriter writer(folder);
  for (int i = first; i < first + count; ++i) {
    writer.writeOnline(estimateOf(i));
    writer.writeTiming(timingOfEstimate(i));
    writer.writeFinal(estimateOf(i));
  }
  writer.finish("{\"complete\": true}\n");
}

TEST(RunFolder, ComesBackAsWritten) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 5, 3);
  const RunFolder run = readRunFolder(folder / "run");
  EXPECT_TRUE(run.complete());
  EXPECT_EQ(run.first_frame, 5);
  ASSERT_EQ(run.final.camera.size(), 3u);
  EXPECT_THAT(run.online.camera[2], IsNearPose(estimateOf(7).T_world_cam, 1e-8));  // nine decimals of numbers below ten
  ASSERT_EQ(run.final.objects.size(), 3u);
  const auto& row = run.final.objects[1];
  EXPECT_EQ(row.frame.value, 6);
  EXPECT_EQ(row.object.track.value, 4);
  EXPECT_THAT(row.object.T_world_body, IsNearPose(estimateOf(6).objects[0].T_world_body, 2e-6));  // six decimals
  EXPECT_EQ(row.object.points, 17);
  EXPECT_DOUBLE_EQ(row.object.box.right_px, 110.5);
  ASSERT_TRUE(row.object.cuboid);
  EXPECT_EQ(row.object.cuboid->center_body, Eigen::Vector3d(1.5, 0.25, -0.125));
  EXPECT_EQ(row.object.cuboid->size_m, Eigen::Vector3d(4, 1.75, 1.5));
  EXPECT_EQ(row.object.cuboid->size_sigma_m, Eigen::Vector3d(0.5, 0.1, 0.1));
  EXPECT_EQ(row.object.cuboid->kind, ObjectKind::kTwoWheeler);
  EXPECT_DOUBLE_EQ(row.object.cuboid->kind_probability, 0.75);
  EXPECT_DOUBLE_EQ(row.object.yaw_rate_radps, -0.125);
  EXPECT_DOUBLE_EQ(row.object.yaw_rate_sigma_radps, 0.03125);
  EXPECT_DOUBLE_EQ(row.object.age_s, 0.6);
  EXPECT_DOUBLE_EQ(row.object.existence_probability, 0.875);
  ASSERT_TRUE(row.object.acceleration);
  EXPECT_DOUBLE_EQ(row.object.acceleration->along_mps2, -2.5);
  EXPECT_DOUBLE_EQ(row.object.acceleration->along_sigma_mps2, 0.5);
  EXPECT_DOUBLE_EQ(row.object.acceleration->yaw_radps2, 0.25);
  EXPECT_DOUBLE_EQ(row.object.acceleration->yaw_sigma_radps2, 0.125);
  ASSERT_EQ(run.online.covariances.size(), 6u);
  EXPECT_FALSE(run.online.covariances[0].track.valid());
  EXPECT_THAT(run.online.covariances[1].covariance, IsNear(Matrix6d::Identity() * 0.01, 1e-12));
  ASSERT_EQ(run.final.covariances.size(), 6u);
  EXPECT_EQ(run.final.covariances[3].track.value, 4);
  for (const RunFolder::Trajectories* kind : {&run.online, &run.final}) {
    ASSERT_EQ(kind->pose_covariances.size(), 3u);
    EXPECT_EQ(kind->pose_covariances[1].frame.value, 6);
    EXPECT_THAT(kind->pose_covariances[1].covariance, IsNear(Matrix6d::Identity() * 7, 1e-12));
  }
  EXPECT_DOUBLE_EQ(run.frames[1].latency_ms, 30.5);
}

TEST(RunFolder, ShowsWhatHasSettledUntilTheRunHasEnded) {
  const test::TemporaryFolder folder;
  {
    RunFolderWriter writer(folder / "run");
    for (int i = 0; i < 4; ++i) {
      writer.writeOnline(estimateOf(i));
      writer.writeTiming(timingOfEstimate(i));
      if (i > 0) writer.writeSettled(estimateOf(i - 1));
    }
    writer.writeFinal(estimateOf(0));
    EXPECT_EQ(readRunFolder(folder / "run").final.camera.size(), 3u);
  }
  const RunFolder run = readRunFolder(folder / "run");
  EXPECT_FALSE(run.complete());
  EXPECT_EQ(run.final.camera.size(), 3u);
  EXPECT_EQ(run.final.objects.size(), 3u);
  for (const auto& file : std::filesystem::directory_iterator(folder / "run"))
    EXPECT_NE(file.path().extension(), ".part");
}

TEST(RunFolder, HasTheDocumentedHeadersAndStamps) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 0, 1);
  EXPECT_THAT(
      folder.read("run/objects_final.csv"),
      testing::StartsWith(
          "frame,track_id,state,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz,vx,vy,vz,speed_sigma_mps,points,left,top,"
          "right,bottom,box_x_m,box_y_m,box_z_m,length_m,width_m,height_m,box_x_sigma_m,box_y_sigma_m,box_z_sigma_m,"
          "length_sigma_m,width_sigma_m,height_sigma_m,kind,kind_probability,heading_rad,heading_sigma_rad,"
          "yaw_rate_radps,yaw_rate_sigma_radps,center_x_m,center_y_m,center_z_m,center_x_sigma_m,center_y_sigma_m,"
          "center_z_sigma_m,age_s,existence_probability,acceleration_mps2,acceleration_sigma_mps2,"
          "yaw_acceleration_radps2,yaw_acceleration_sigma_radps2\n"
          "0,4,moving,"));
  EXPECT_THAT(folder.read("run/camera_online.tum"), testing::StartsWith("1317042651.174740992 0.000000000 "));
  EXPECT_THAT(folder.read("run/camera_final.txt"), testing::StartsWith("1.000000000e+00 0.000000000e+00 "));
}

TEST(RunFolder, RowsTellWhereTheCuboidStandsAndHeads) {
  const test::TemporaryFolder folder;
  RunFolderWriter writer(folder.path());
  FrameEstimate estimate = estimateOf(0);
  Eigen::Matrix3d world_body;
  world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;  // ahead is z, left -x, up -y
  estimate.objects[0].T_world_body = SE3(world_body, {4, 1, 20});
  writer.writeOnline(estimate);
  // The pose is good to 0.1 m and rad: the middle, 1.5 m ahead, .25 m left and .125 m below, to .1 and .1 times what is
  // across the axis.
  EXPECT_THAT(
      folder.read("objects_online.csv"),
      testing::EndsWith(",two_wheeler,0.750,0.000000,0.100000,-0.125000,0.031250,3.750,1.125,21.500,0.181,0.182,"
                        "0.104,0.000,0.875,-2.5000,0.5000,0.250000,0.125000\n"));
}

/// A table without its last columns, as earlier versions wrote it.
std::string withoutLast(const std::string& csv, int columns) {
  std::string earlier;
  for (std::size_t begin = 0; begin < csv.size();) {
    const std::size_t end = csv.find('\n', begin);
    std::string line = csv.substr(begin, end - begin);
    for (int column = 0; column < columns; ++column) line.resize(line.rfind(','));
    earlier += line + '\n';
    begin = end + 1;
  }
  return earlier;
}

TEST(RunFolder, ReadsRowsOfEarlierVersionsToo) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 1, 2);
  EXPECT_FALSE(readRunFolder(folder / "run").final.objects[1].object.cuboid);  // not known in that frame
  const std::string csv = folder.read("run/objects_final.csv");
  EXPECT_FALSE(readRunFolder(folder / "run").final.objects[0].object.acceleration) << "its cells are empty";
  constexpr int kAcceleration = 4, kExistence = kAcceleration + 1, kPlaceAndMotion = kExistence + 11, kCuboid = 14;
  folder.write("run/objects_final.csv", withoutLast(csv, kAcceleration));
  EXPECT_DOUBLE_EQ(readRunFolder(folder / "run").final.objects[1].object.existence_probability, 0.875);
  EXPECT_FALSE(readRunFolder(folder / "run").final.objects[1].object.acceleration);
  folder.write("run/objects_final.csv", withoutLast(csv, kExistence));
  const auto without_existence = readRunFolder(folder / "run").final.objects;
  EXPECT_DOUBLE_EQ(without_existence[0].object.age_s, 0.1);
  EXPECT_EQ(without_existence[0].object.existence_probability, 1) << "they reported what they held for there";
  folder.write("run/objects_final.csv", withoutLast(csv, kPlaceAndMotion));
  EXPECT_TRUE(readRunFolder(folder / "run").final.objects[0].object.cuboid);
  folder.write("run/objects_final.csv", withoutLast(csv, kPlaceAndMotion + kCuboid));
  const RunFolder run = readRunFolder(folder / "run");
  ASSERT_EQ(run.final.objects.size(), 2U);
  EXPECT_FALSE(run.final.objects[0].object.cuboid);
  EXPECT_DOUBLE_EQ(run.final.objects[0].object.box.bottom_px, 90.25);
}

TEST(RunFolder, AnAccelerationIsWholeOrMissing) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 2, 1);
  std::string csv = folder.read("run/objects_final.csv");
  csv.replace(csv.find("-2.5000"), std::string_view("-2.5000").size(), "");
  folder.write("run/objects_final.csv", csv);
  EXPECT_THAT(messageOf<InputError>([&] { readRunFolder(folder / "run"); }),
              AllOf(HasSubstr("objects_final.csv, line 2"), HasSubstr("a part of an acceleration")));
}

TEST(RunFolder, RejectedStampsStayOutOfTheTumFiles) {
  const test::TemporaryFolder folder;
  RunFolderWriter writer(folder.path());
  FrameEstimate rejected = estimateOf(0);
  rejected.head.status = FrameStatus::kRejected;
  writer.writeOnline(rejected);
  EXPECT_EQ(folder.read("camera_online.tum"), "");
  EXPECT_NE(folder.read("camera_online.txt"), "");
}

TEST(RunFolder, WhatAKilledRunLeftIsReadable) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 0, 3);
  std::filesystem::remove(folder / "run/summary.json");
  std::filesystem::remove(folder / "run/objects_online.csv");
  for (const char* name : {"run/camera_final.txt", "run/objects_final.csv", "run/frames.csv"}) {
    const std::string whole = folder.read(name);
    folder.write(name, std::string_view(whole).substr(0, whole.size() - 4));
  }
  const RunFolder run = readRunFolder(folder / "run");
  EXPECT_FALSE(run.complete());
  EXPECT_EQ(run.final.camera.size(), 2u);
  EXPECT_EQ(run.final.objects.size(), 2u);
  EXPECT_EQ(run.frames.size(), 2u);
  EXPECT_EQ(run.online.camera.size(), 3u);
  EXPECT_TRUE(run.online.objects.empty());
}

TEST(RunFolder, DamagedLinesAreNamed) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 0, 2);
  std::string csv = folder.read("run/objects_final.csv");
  csv.replace(csv.find("moving"), 6, "flying");
  folder.write("run/objects_final.csv", csv);
  EXPECT_THAT(messageOf<InputError>([&] { readRunFolder(folder / "run"); }),
              AllOf(HasSubstr("objects_final.csv, line 2"), HasSubstr("flying")));
  EXPECT_THAT(messageOf<InputError>([&] { readRunFolder(folder.path()); }), HasSubstr("is no run folder"));
}

TEST(RunFolder, ANewRunRemovesTheOldSummaryFirst) {
  const test::TemporaryFolder folder;
  writeRun(folder / "run", 0, 2);
  const RunFolderWriter second(folder / "run");
  EXPECT_FALSE(readRunFolder(folder / "run").complete());
}

TEST(RunFolder, OutputsThatCannotBeWrittenAreNamed) {
  const test::TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_THAT(messageOf<OutputError>([&] { RunFolderWriter(folder / "file"); }), HasSubstr("file"));
  std::filesystem::create_directories(folder / "run/camera_online.txt");
  EXPECT_THAT(messageOf<OutputError>([&] { RunFolderWriter(folder / "run"); }), HasSubstr("camera_online.txt"));
}

TEST(LineFile, WhatDoesNotFitIsNamed) {
  const test::TemporaryFolder folder;
  LineFile cut(folder / "cut.csv");
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlim_t before = std::exchange(limit.rlim_cur, 10);
  setrlimit(RLIMIT_FSIZE, &limit);
  const std::string message = messageOf<OutputError>([&] { cut.writeLine("more than ten bytes"); });
  limit.rlim_cur = before;
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, AllOf(HasSubstr("cut.csv"), HasSubstr("too large")));
}

TEST(Trajectory, KittiLinesComeBackAndBadOnesAreNamed) {
  const test::TemporaryFolder folder;
  const std::vector<SE3> poses{SE3(), estimateOf(3).T_world_cam};
  writeKittiPoses(folder / "poses.txt", poses);
  EXPECT_THAT(readKittiPoses(folder / "poses.txt").at(1), IsNearPose(poses[1], 1e-8));
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1\n");
  EXPECT_THAT(messageOf<InputError>([&] { readKittiPoses(folder / "poses.txt"); }), HasSubstr("line 2"));
  folder.write("poses.txt", "2 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(messageOf<InputError>([&] { readKittiPoses(folder / "poses.txt"); }), HasSubstr("rotation"));
}

}  // namespace
}  // namespace motorcade
