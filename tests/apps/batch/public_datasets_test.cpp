#include <gmock/gmock.h>

#include "apps/tasks/batch_folder.hpp"
#include "tests/apps/program_run.hpp"
#include "tests/support/virtual_kitti_drive.hpp"

/// `motorcade batch` with the manifests of public data sets, on roots where most drives are missing.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// KITTI-360's calibration from that of a plain drive.
std::string perspectiveOf(const std::string& calibration) {
  std::istringstream lines(calibration);
  std::string text = "R_rect_00: 1 0 0 0 1 0 0 0 1\n";
  for (std::string line; std::getline(lines, line);)
    for (const std::string camera : {"0", "1"})
      if (line.starts_with("P" + camera + ":")) text += "P_rect_0" + camera + line.substr(2) + "\n";
  return text;
}

class PublicDatasetBatch : public Run {
 protected:
  PublicDatasetBatch() { fs::create_directories(root()); }

  fs::path root() const { return out("root"); }
  fs::path merged(const char* file) const { return BatchFolder(out("batch")).merged() / file; }
  std::string output() const { return contentOf(out("stdout")); }
  int batch(const std::string& manifest, const std::string& options, const std::string& prefix = "") {
    return motorcade("batch " MOTORCADE_SOURCE_DIR "/perf/datasets/" + manifest + " --out " + out("batch").string() +
                         " -j 1 --threads 1 " + options,
                     prefix);
  }
  void write(const fs::path& place, const std::string& content) {
    fs::create_directories((root() / place).parent_path());
    std::ofstream(root() / place) << content;
  }
  void link(const fs::path& what, const fs::path& place) {
    fs::create_directories((root() / place).parent_path());
    fs::create_symlink(kSequence / what, root() / place);
  }
};

TEST_F(PublicDatasetBatch, WhatIsNotOnTheDiskIsNamedAndLeftOut) {
  link("image_0", "training/image_02/0003");
  link("image_1", "training/image_03/0003");
  link("calib.txt", "training/calib/0003.txt");
  link("label_02.txt", "training/label_02/0003.txt");
  link("poses.txt", "training/poses/0003.txt");
  ASSERT_EQ(batch("kitti_tracking.toml", "--root " + root().string()), 0) << contentOf(errors());
  EXPECT_THAT(output(), AllOf(HasSubstr("20 of 21 drives are not on the disk and left out: 0000, 0001, 0002, 0004"),
                              HasSubstr("training/image_02/0000 or image_02/0000"),
                              HasSubstr("1 tasks: 1 done, 0 finished before, 0 failed")));
  for (const char* const file : {"results.md", "report.html"})
    EXPECT_THAT(contentOf(merged(file)),
                AllOf(HasSubstr("Left out, as not on the disk"), HasSubstr("root/training/image_02/0020 or"),
                      HasSubstr("Not beside published figures, as of other frames")))
        << file;
  EXPECT_THAT(contentOf(merged("results.csv")), HasSubstr("\npublished.DynoSAM,0003,DynoSAM,,,published,"));
  const auto json = nlohmann::json::parse(contentOf(merged("results.json")));
  EXPECT_EQ(json["left_out"].size(), 20U);
  EXPECT_EQ(json["left_out"][0]["drive"], "0000");
}

TEST_F(PublicDatasetBatch, TheRootMayComeFromTheEnvironment) {
  for (const char* const name : {"image_0", "image_1", "calib.txt", "times.txt"})
    link(name, fs::path("dataset/sequences/04") / name);
  link("poses.txt", "dataset/poses/04.txt");
  ASSERT_EQ(batch("kitti_odometry.toml", "", "KITTI_ODOMETRY=" + root().string() + " "), 0) << contentOf(errors());
  EXPECT_THAT(output(), HasSubstr("10 of 11 drives are not on the disk"));
  EXPECT_TRUE(fs::exists(evaluationIn(BatchFolder(out("batch")).result("04.default"))));
}

TEST_F(PublicDatasetBatch, FramesWithoutTruthAreLeftOut) {
  const std::string drive = "data_2d_raw/2013_05_28_drive_0003_sync/";
  for (std::size_t i = 0; i < kFrames; ++i) {
    const std::string number = (i < 10 ? "000000000" : "00000000") + std::to_string(i) + ".png";
    const std::string image = (i < 10 ? "00000" : "0000") + std::to_string(i) + ".png";
    link("image_0/" + image, drive + "image_00/data_rect/" + number);
    link("image_1/" + image, drive + "image_01/data_rect/" + number);
  }
  write("calibration/perspective.txt", perspectiveOf(contentOf(kSequence / "calib.txt")));
  std::istringstream poses(contentOf(kSequence / "poses.txt"));
  std::string known;
  std::size_t frame = 0;
  for (std::string line; std::getline(poses, line); ++frame)
    if (frame >= 2 && frame < kFrames - 1) known += std::to_string(frame) + " " + line + " 0 0 0 1\n";
  write("data_poses/2013_05_28_drive_0003_sync/cam0_to_world.txt", known);
  ASSERT_EQ(batch("kitti_360.toml", "--root " + root().string()), 0) << contentOf(errors());
  const fs::path result = BatchFolder(out("batch")).result("0003.default");
  const auto measures = nlohmann::json::parse(contentOf(evaluationIn(result)));
  EXPECT_EQ(measures["final"]["frames"], kFrames - 3);
}

TEST_F(PublicDatasetBatch, VirtualKittiIsMeasuredWithItsMasks) {
  const auto drive = virtualKittiDriveOf(kSequence);
  ASSERT_TRUE(drive);
  drive->write(root() / "Scene20/15-deg-left");
  ASSERT_EQ(batch("virtual_kitti_2.toml", "--root " + root().string()), 0) << contentOf(errors());
  EXPECT_THAT(output(), HasSubstr("49 of 50 drives are not on the disk"));
  const fs::path result = BatchFolder(out("batch")).result("Scene20_15-deg-left.default");
  const auto measures = nlohmann::json::parse(contentOf(evaluationIn(result)));
  EXPECT_EQ(measures["truth"]["camera"], "extrinsic.txt");
  EXPECT_TRUE(measures["masks"].is_object());
  EXPECT_TRUE(measures["final"]["camera_mounted"].is_null());  // nothing of exact truth is fitted
}

TEST_F(PublicDatasetBatch, WithNothingThereItSaysWhatWasLookedFor) {
  EXPECT_EQ(batch("euroc.toml", "--root " + root().string()), 3);
  EXPECT_THAT(contentOf(errors()),
              AllOf(HasSubstr("none of its 11 drives is on the disk"), HasSubstr("--root FOLDER"),
                    HasSubstr("MH_01: " + root().string() + "/MH_01_easy or MH_01 or machine_hall/MH_01_easy"),
                    HasSubstr("and 6 more")));
  EXPECT_FALSE(fs::exists(out("batch")));
  EXPECT_EQ(batch("virtual_kitti_2.toml", "", "env -u VIRTUAL_KITTI_2 "), 2);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("$VIRTUAL_KITTI_2, which is not set"), HasSubstr("Scene01/clone")));
}

}  // namespace
}  // namespace motorcade::test
