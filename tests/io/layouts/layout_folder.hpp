#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {

/// A folder in which a test lays out a sequence of small images.
class LayoutFolder : public testing::Test {
 protected:
  void writeImage(const std::filesystem::path& file, std::uint8_t level = 77) {
    Image image = pool_.acquire(64, 48);
    for (int y = 0; y < 48; ++y) std::fill_n(image.mutableRow(y), 64, level);
    std::filesystem::create_directories((folder_ / file).parent_path());
    writePng(folder_ / file, image);
  }
  std::string openError(const std::filesystem::path& name = "", const GivenCameras& given = {}) {
    return test::messageOf<InputError>([&] { openSequence(folder_ / name, 10, given); });
  }

  test::TemporaryFolder folder_;
  ImagePool pool_;
};

}  // namespace motorcade
