#include "apps/run/given_knowledge.hpp"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

constexpr StereoCamera kCamera{
    .fx_px = 60, .fy_px = 60, .cx_px = 50, .cy_px = 30, .baseline_m = 0.5, .width_px = 100, .height_px = 60};

/// Complaint about an item that cannot be used; empty where it can.
std::string complaintAbout(const std::string& item) {
  try {
    ignoredPixels({item}, kCamera);
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

TEST(IgnoredPixels, AreNoneUnlessNamed) { EXPECT_TRUE(ignoredPixels({}, kCamera).empty()); }

TEST(IgnoredPixels, SidesAddUp) {
  const PixelMask mask = ignoredPixels({"bottom=10", "left=5", "top=1", "right=2"}, kCamera);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 100; ++x) EXPECT_EQ(mask.holds(x, y), y >= 50 || x < 5 || y < 1 || x >= 98) << x << " " << y;
  EXPECT_FALSE(mask.holds(50, 60));
  EXPECT_TRUE(mask.holds(50, 49.6)) << "nearer to the middle of row 50";
}

TEST(IgnoredPixels, AnImageNamesThoseThatAreNotBlack) {
  const test::TemporaryFolder folder;
  ImagePool pool;
  Image image = pool.acquire(100, 60);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 100; ++x) image.mutableRow(y)[x] = x == 7 && y == 8 ? 1 : 0;
  const auto file = folder.path() / "mask.png";
  writePng(file, image);
  const PixelMask mask = ignoredPixels({file.string(), "top=1"}, kCamera);
  EXPECT_TRUE(mask.holds(7, 8));
  EXPECT_TRUE(mask.holds(20, 0));
  EXPECT_FALSE(mask.holds(8, 8));
}

TEST(IgnoredPixels, WhatCannotBeUsedIsNamed) {
  EXPECT_THAT(complaintAbout("bottom=60"), HasSubstr("--ignore bottom=60: write a number from 1 to 59"));
  EXPECT_THAT(complaintAbout("left=-1"), HasSubstr("--ignore left=-1: write a number from 1 to 99"));
  EXPECT_THAT(complaintAbout("top=3px"), HasSubstr("--ignore top=3px"));
  EXPECT_THAT(complaintAbout("below=3"), HasSubstr("neither a file nor a side"));
  const test::TemporaryFolder folder;
  ImagePool pool;
  const auto file = folder.path() / "small.png";
  writePng(file, pool.acquire(50, 60));
  EXPECT_THAT(complaintAbout(file.string()), HasSubstr("50x60"));
}

}  // namespace
}  // namespace motorcade
