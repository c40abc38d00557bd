#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "io/images/image_file.hpp"
#include "tests/apps/program_run.hpp"

/// The rendered drive with a bonnet in the lowest rows of its images, and what `run` and `check` make of it.
namespace motorcade::test {
namespace {

using testing::HasSubstr;

constexpr int kRows = 70, kDisparity_px = 150;  // 2.6 m ahead

/// A smooth random texture of a bonnet, as wide as both images see of it.
class Bonnet {
 public:
  explicit Bonnet(int width) : width_(width + kDisparity_px) {
    std::mt19937 random(1);
    std::vector<int> grain(static_cast<std::size_t>(width_) * kRows);
    for (int& value : grain) value = static_cast<int>(random() % 256);
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < width_; ++x) gray_.push_back(meanAround(grain, x, y));
  }
  std::uint8_t at(int x, int y) const { return gray_[static_cast<std::size_t>(y) * width_ + x]; }

 private:
  std::uint8_t meanAround(const std::vector<int>& grain, int at_x, int at_y) const {
    constexpr int kReach_px = 1;
    int sum = 0, count = 0;
    for (int y = std::max(0, at_y - kReach_px); y <= std::min(kRows - 1, at_y + kReach_px); ++y)
      for (int x = std::max(0, at_x - kReach_px); x <= std::min(width_ - 1, at_x + kReach_px); ++x, ++count)
        sum += grain[static_cast<std::size_t>(y) * width_ + x];
    return static_cast<std::uint8_t>(sum / count);
  }

  int width_;
  std::vector<std::uint8_t> gray_;
};

class OwnVehicleRun : public Run {
 protected:
  fs::path driveWithBonnet() {
    fs::path copy = out("drive");
    fs::copy(kSequence, copy, fs::copy_options::recursive);
    ImagePool pool;
    for (const auto& [side, shift_px] : {std::pair("image_0", 0), std::pair("image_1", kDisparity_px)}) {
      for (const auto& entry : fs::directory_iterator(copy / side)) {
        Image image = readImage(entry.path(), pool);
        const Bonnet bonnet(image.width());
        for (int y = 0; y < kRows; ++y)
          for (int x = 0; x < image.width(); ++x)
            image.mutableRow(image.height() - kRows + y)[x] = bonnet.at(x + shift_px, y);
        writePng(entry.path(), image);
      }
    }
    return copy;
  }
};

TEST_F(OwnVehicleRun, ABonnetIsFoundAndBearsNoObjects) {
  const fs::path drive = driveWithBonnet();
  ASSERT_EQ(run("out", "", drive), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(errors()), HasSubstr("the own vehicle fills"));
  EXPECT_GT(summary("out")["own_vehicle"]["image_share"], 0.1);
  const auto measured = evaluate("out", drive)["final"];
  EXPECT_EQ(measured["detection"]["false_rows"], 0);
  EXPECT_LT(measured["camera"]["rpe_t_m"]["rmse"], 0.01);  // as on the drive without it
  ASSERT_EQ(motorcade("check " + drive.string()), 0);
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("warning (own_vehicle): the own vehicle fills"));
}

TEST_F(OwnVehicleRun, IgnoredRowsTakeTheBonnetOutFromTheStart) {
  const fs::path drive = driveWithBonnet();
  ASSERT_EQ(run("out", "--ignore bottom=" + std::to_string(kRows), drive), 0) << contentOf(errors());
  EXPECT_EQ(summary("out")["own_vehicle"], nullptr);
  EXPECT_EQ(evaluate("out", drive)["final"]["detection"]["false_rows"], 0);
}

}  // namespace
}  // namespace motorcade::test
