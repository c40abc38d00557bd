#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "io/images/image_file.hpp"
#include "tests/apps/program_run.hpp"

/// `motorcade run --instances`: labels from elsewhere, here those with which the drive was rendered.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RunInstances : public Run {
 protected:
  /// Labels of every third frame.
  fs::path labels() const {
    fs::path folder = out("labels");
    fs::create_directories(folder);
    for (const char* name : {"000000.png", "000003.png", "000006.png"})
      fs::copy_file(kSequence / "instance" / name, folder / name, fs::copy_options::overwrite_existing);
    return folder;
  }
  int runWith(const std::string& name, const fs::path& instances) {
    return run(name, "--frames 0:8 --instances " + instances.string());
  }
  void expectRefused(const fs::path& instances, const std::string& why) {
    EXPECT_EQ(runWith("refused", instances), 3) << why;
    EXPECT_THAT(contentOf(errors()), HasSubstr(why));
    EXPECT_FALSE(fs::exists(out("refused")));
  }
};

TEST_F(RunInstances, LabelsOfEveryThirdFrameAreTakenAndRemembered) {
  const fs::path folder = labels();
  ASSERT_EQ(runWith("labelled", folder), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(errors()),
              AllOf(HasSubstr("instance labels come from " + folder.string()), Not(HasSubstr("left out"))));
  EXPECT_EQ(summary("labelled")["instances"], folder.string());
  EXPECT_TRUE(summary("labelled")["findings"].empty());
  ASSERT_EQ(run("plain", "--frames 0:8"), 0) << contentOf(errors());
  EXPECT_EQ(summary("plain")["instances"], "");
}

/// Overlap of masks and boxes to 30 m with the truth.
struct Overlap {
  double masks, boxes;
  explicit Overlap(const nlohmann::json& measures)
      : masks(measures["masks"]["within_30m"]["iou"]), boxes(measures["final"]["boxes_within_30m"]["iou_2d"]) {}
};

TEST_F(RunInstances, ExactLabelsMakeMasksAndBoxesBetterAndThoseOfOtherFramesNoWorse) {
  const fs::path others = out("others");
  fs::create_directories(others);
  for (const auto& entry : fs::directory_iterator(kSequence / "instance")) {
    std::string name = std::to_string(kFrames - 1 - std::stoul(entry.path().stem().string()));
    name.insert(0, 6 - name.size(), '0');
    fs::copy_file(entry.path(), others / (name + ".png"));
  }
  ASSERT_EQ(run("plain", "--masks"), 0) << contentOf(errors());
  ASSERT_EQ(run("exact", "--masks --instances " + (kSequence / "instance").string()), 0) << contentOf(errors());
  ASSERT_EQ(run("lying", "--masks --instances " + others.string()), 0) << contentOf(errors());
  const Overlap plain(evaluate("plain")), exact(evaluate("exact")), lying(evaluate("lying"));
  EXPECT_GT(exact.masks, plain.masks + 0.03);
  EXPECT_GT(exact.boxes, plain.boxes + 0.02);
  EXPECT_GT(lying.masks, 0.98 * plain.masks);
  EXPECT_GT(lying.boxes, 0.98 * plain.boxes);
}

TEST_F(RunInstances, ADamagedFileIsLeftOutAndToldAtTheEnd) {
  const fs::path folder = labels();
  fs::resize_file(folder / "000003.png", 60);
  ASSERT_EQ(runWith("damaged", folder), 0) << contentOf(errors());
  const std::string told = "a file of instance labels is left out: " + (folder / "000003.png").string();
  EXPECT_THAT(contentOf(errors()), HasSubstr(told));
  const auto json = summary("damaged");
  EXPECT_EQ(json["complete"], true);
  ASSERT_EQ(json["findings"].size(), 1U);
  EXPECT_EQ(json["findings"][0]["name"], "instances");
  EXPECT_EQ(json["findings"][0]["worthless"], false);
  EXPECT_THAT(json["findings"][0]["text"].get<std::string>(), HasSubstr(told));
}

TEST_F(RunInstances, WhatHoldsNoLabelsOfTheDriveEndsTheRunBeforeItBegins) {
  expectRefused(out("nowhere"), "nowhere: is no folder");
  expectRefused(kSequence / "calib.txt", "calib.txt: is no folder");
  expectRefused(kSequence, "holds no instance labels; they are called NNNNNN.png");
  const fs::path folder = labels();
  Gray16Image small;
  small.width = small.height = 16;
  small.pixels.assign(256, 1);
  writePng16(folder / "000000.png", small);
  expectRefused(folder, "000000.png: has 16 x 16 pixels, the rectified images have 1242 x 375");
  std::ofstream(folder / "000000.png") << "no image";
  expectRefused(folder, "000000.png");
}

}  // namespace
}  // namespace motorcade::test
