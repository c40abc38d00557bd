#include "apps/draw/video_writer.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

RgbImage picture(int width, int height, std::uint8_t level) {
  RgbImage image{.width = width, .height = height, .pixels = {}};
  image.pixels.assign(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), level);
  return image;
}

/// Properties of a video by the tool beside ffmpeg: codec, size, pixel format, rate, pictures.
std::string probed(const fs::path& file) {
  const std::string command =
      "ffprobe -loglevel error -count_frames -show_entries "
      "stream=codec_name,width,height,pix_fmt,avg_frame_rate,nb_read_frames -of csv=p=0 '" +
      file.string() + "'";
  std::string output;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  std::array<char, 256> part;
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) output.append(part.data(), got);
  ::pclose(pipe);
  return output;
}

class Video : public testing::Test {
 protected:
  /// A program that stands in for ffmpeg.
  fs::path standIn(const std::string& script) const {
    fs::path program = folder_.write("bin/ffmpeg", "#!/bin/sh\n" + script + "\n");
    fs::permissions(program, fs::perms::owner_all);
    return program;
  }
  /// Writes until an error comes, at most some seconds of video.
  void writeMany(VideoWriter& writer) const {
    for (int i = 0; i < 200; ++i) writer.write(picture(320, 200, 0));
    writer.finish();
  }

  test::TemporaryFolder folder_;
  std::atomic<bool> stop_ = false;
};

TEST_F(Video, HoldsThePicturesAtTheirRateInAnEvenSize) {
  const auto ffmpeg = findFfmpeg();
  if (!ffmpeg) GTEST_SKIP() << "no ffmpeg is installed";
  for (const auto& [name, codec] : {std::pair("a.mp4", "h264"), std::pair("a.webm", "vp9")}) {
    VideoWriter writer(folder_ / name, {{101, 75}, 12.5}, *ffmpeg, stop_);
    for (int i = 0; i < 10; ++i) writer.write(picture(101, 75, static_cast<std::uint8_t>(20 * i)));
    EXPECT_FALSE(fs::exists(folder_ / name)) << "it is there when it is whole";
    writer.finish();
    EXPECT_THAT(probed(folder_ / name), AllOf(HasSubstr(codec), HasSubstr("102,76"), HasSubstr("yuv420p"),
                                              HasSubstr("25/2"), HasSubstr(",10")));
    EXPECT_FALSE(fs::exists(folder_ / (std::string(name) + ".part")));
  }
}

TEST_F(Video, SaysWhatFfmpegSaysWhenItFails) {
  const auto ffmpeg = standIn("echo 'the disk is full' >&2; echo more >&2; exit 1");
  VideoWriter writer(folder_ / "a.mp4", {{320, 200}, 10}, ffmpeg, stop_);
  EXPECT_THAT(test::messageOf<OutputError>([&] { writeMany(writer); }),
              AllOf(HasSubstr("a.mp4"), HasSubstr("the disk is full"), testing::Not(HasSubstr("more"))));
}

TEST_F(Video, AnFfmpegThatDiesIsToldOf) {
  const auto ffmpeg = standIn("kill -9 $$");
  VideoWriter writer(folder_ / "a.mp4", {{320, 200}, 10}, ffmpeg, stop_);
  EXPECT_THAT(test::messageOf<OutputError>([&] { writeMany(writer); }), HasSubstr("signal 9"));
}

TEST_F(Video, AFailureAtTheEndIsAFailureAndTheOldFileStays) {
  folder_.write("a.mp4", "old");
  const auto ffmpeg = standIn("cat >/dev/null; echo 'no space' >&2; exit 1");
  VideoWriter writer(folder_ / "a.mp4", {{320, 200}, 10}, ffmpeg, stop_);
  EXPECT_THAT(test::messageOf<OutputError>([&] { writeMany(writer); }), HasSubstr("no space"));
  EXPECT_EQ(folder_.read("a.mp4"), "old");
}

TEST_F(Video, StoppingEndsAnFfmpegThatTakesNothing) {
  const auto ffmpeg = standIn("exec sleep 60");
  const auto begun = std::chrono::steady_clock::now();
  {
    VideoWriter writer(folder_ / "a.mp4", {{320, 200}, 10}, ffmpeg, stop_);
    const std::jthread stopping([this] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      stop_ = true;
    });
    writeMany(writer);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(30));
  EXPECT_FALSE(fs::exists(folder_ / "a.mp4"));
}

TEST_F(Video, PicturesHaveOneSize) {
  VideoWriter writer(folder_ / "a.mp4", {{320, 200}, 10}, standIn("cat >/dev/null"), stop_);
  EXPECT_THAT(test::messageOf<OutputError>([&] { writer.write(picture(322, 200, 0)); }),
              AllOf(HasSubstr("322x200"), HasSubstr("320x200")));
}

TEST_F(Video, IsMadeByTheFfmpegOfThePath) {
  const char* const before = std::getenv("PATH");
  const std::string kept = before ? before : "";
  const auto program = standIn("exit 0");
  ::setenv("PATH", ("/nowhere:" + program.parent_path().string()).c_str(), 1);
  EXPECT_EQ(findFfmpeg(), program);
  ::setenv("PATH", folder_.path().c_str(), 1);
  EXPECT_EQ(findFfmpeg(), std::nullopt);
  ::setenv("PATH", kept.c_str(), 1);
}

TEST_F(Video, IsNamedAsOneOfTwoFormats) {
  requireVideoName("a.mp4");
  requireVideoName("a.webm");
  EXPECT_THAT(test::messageOf<UsageError>([] { requireVideoName("a.avi"); }), HasSubstr(".webm"));
}

}  // namespace
}  // namespace motorcade
