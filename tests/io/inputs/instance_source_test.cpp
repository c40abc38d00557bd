#include "io/inputs/instance_source.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/io/three_pairs.hpp"
#include "tests/support/virtual_kitti_drive.hpp"

namespace motorcade {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class InstanceFolder : public testing::Test {
 protected:
  static constexpr int kWidth_px = 20, kHeight_px = 16;

  /// Labels that count up from `first`, pixel by pixel.
  void write(const std::string& name, std::uint16_t first, int width_px = kWidth_px) const {
    Gray16Image image;
    image.width = width_px;
    image.height = kHeight_px;
    for (int i = 0; i < width_px * kHeight_px; ++i) image.pixels.push_back(static_cast<std::uint16_t>(first + i));
    writePng16(folder_ / name, image);
  }
  std::string refusal() const {
    return test::messageOf<InputError>([&] { requireInstances(folder_.path(), kWidth_px, kHeight_px); });
  }
  InstanceSource source() const {
    return {std::make_unique<test::ThreePairs>(), folder_.path(), kWidth_px, kHeight_px};
  }
  /// The first label of each pair; -1 where it has none.
  static std::vector<int> firstLabels(InstanceSource& source) {
    std::vector<int> labels;
    while (const auto frame = source.next())
      labels.push_back(frame->inputs.instances ? frame->inputs.instances->row(0)[0] : -1);
    return labels;
  }

  test::TemporaryFolder folder_;
};

TEST_F(InstanceFolder, EachPairHasTheLabelsOfItsNumber) {
  write("000000.png", 1000);
  write("000001.png", 2000);
  write("000002.png", 3000);
  auto pairs = source();
  const auto first = pairs.next(), second = pairs.next();
  ASSERT_TRUE(first && second && first->inputs.instances && second->inputs.instances);
  const InstanceLabels& labels = *first->inputs.instances;
  ASSERT_EQ(labels.width(), kWidth_px);
  ASSERT_EQ(labels.height(), kHeight_px);
  for (int y = 0; y < kHeight_px; ++y)
    for (int x = 0; x < kWidth_px; ++x) EXPECT_EQ(labels.row(y)[x], 1000 + kWidth_px * y + x);
  EXPECT_EQ(second->inputs.instances->row(0)[0], 2000);
  EXPECT_THAT(firstLabels(pairs), testing::ElementsAre(3000));
  EXPECT_TRUE(pairs.finish().instances.empty());
}

TEST_F(InstanceFolder, PairsWithoutAFileHaveNone) {
  write("000000.png", 10);
  write("000002.png", 20);
  auto pairs = source();
  EXPECT_THAT(firstLabels(pairs), testing::ElementsAre(10, -1, 20));
  EXPECT_TRUE(pairs.finish().instances.empty());
}

TEST_F(InstanceFolder, PalettesAndEightBitsAreReadAsTheyAre) {
  const std::vector<std::uint8_t> indices(std::size_t{kWidth_px} * kHeight_px, 3);
  test::writeIndexedPng(folder_ / "000000.png", kWidth_px, kHeight_px, indices);
  ImagePool pool;
  Image gray = pool.acquire(kWidth_px, kHeight_px);
  for (int y = 0; y < kHeight_px; ++y) std::fill_n(gray.mutableRow(y), kWidth_px, std::uint8_t{200});
  writePng(folder_ / "000001.png", gray);
  auto pairs = source();
  EXPECT_THAT(firstLabels(pairs), testing::ElementsAre(3, 200, -1));
}

TEST_F(InstanceFolder, WhatIsDamagedInTheMiddleIsLeftOutAndTold) {
  write("000000.png", 10);
  folder_.write("000001.png", "no image");
  write("000002.png", 20, kWidth_px + 1);
  EXPECT_NO_THROW(requireInstances(folder_.path(), kWidth_px, kHeight_px));
  auto pairs = source();
  EXPECT_THAT(firstLabels(pairs), testing::ElementsAre(10, -1, -1));
  const SourceEnd end = pairs.finish();
  EXPECT_THAT(end.instances, AllOf(StartsWith("2 files of instance labels are left out: "), HasSubstr("000001.png")));
  EXPECT_EQ(end.remark, "the end");
  EXPECT_FALSE(end.damaged);
}

TEST_F(InstanceFolder, OneFileThatIsLeftOutIsToldAsOne) {
  folder_.write("000001.png", "no image");
  auto pairs = source();
  firstLabels(pairs);
  EXPECT_THAT(pairs.finish().instances, StartsWith("a file of instance labels is left out: "));
}

TEST_F(InstanceFolder, LabelsOfOtherFramesAreTold) {
  write("000100.png", 10);
  EXPECT_NO_THROW(requireInstances(folder_.path(), kWidth_px, kHeight_px));
  auto pairs = source();
  EXPECT_THAT(firstLabels(pairs), testing::ElementsAre(-1, -1, -1));
  EXPECT_THAT(pairs.finish().instances, HasSubstr("no instance labels of any frame that was taken"));
}

TEST_F(InstanceFolder, WhatHoldsNoLabelsIsRefused) {
  EXPECT_THAT(refusal(), AllOf(StartsWith(folder_.path().string()), HasSubstr("NNNNNN.png")));
  folder_.write("car.png", "");
  folder_.write("000000.txt", "");
  EXPECT_THAT(refusal(), HasSubstr("holds no instance labels"));
  for (const auto& none : {folder_ / "car.png", folder_ / "nowhere"})
    EXPECT_THAT(test::messageOf<InputError>([&] { requireInstances(none, kWidth_px, kHeight_px); }),
                AllOf(StartsWith(none.string()), HasSubstr("is no folder")));
}

TEST_F(InstanceFolder, TheFirstByNameIsRefusedWhereItIsOfNoUse) {
  write("000009.png", 10);
  write("000004.png", 10, kWidth_px - 1);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("000004.png"), HasSubstr("19 x 16 pixels"), HasSubstr("have 20 x 16")));
  folder_.write("000003.png", "no image");
  EXPECT_THAT(refusal(), HasSubstr("000003.png"));
}

}  // namespace
}  // namespace motorcade
