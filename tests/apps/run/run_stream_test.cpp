#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/inputs/pair_reader.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/apps/program_run.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/y4m_stream_text.hpp"

/// `motorcade run -`: pairs that come through a pipe.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

const std::vector<std::string> kTables{"objects_online.csv", "objects_final.csv", "covariances.csv",
                                       "camera_online.txt",  "camera_final.txt",  "camera_online.tum",
                                       "camera_final.tum"};

class RunStream : public Run {
 protected:
  /// The pairs of a drive as a file with a stream.
  fs::path streamOf(const fs::path& drive, StereoPacking packing, const std::string& tags = "F10:1 Ip Cmono") {
    const Sequence sequence = openSequence(drive);
    PairReader reader(sequence);
    fs::path file = out("stream.y4m");
    std::ofstream stream(file, std::ios::binary);
    stream << y4mHeaderLine({sequence.camera.width_px, sequence.camera.height_px}, packing, tags);
    for (const FramePaths& frame : sequence.frames)
      stream << y4mFrame(reader.read(frame, StereoSide::kLeft), reader.read(frame, StereoSide::kRight), packing);
    return file;
  }
  int runPiped(const std::string& name, const fs::path& stream, const std::string& options) {
    return motorcade("run - --out " + out(name).string() + " " + options, "cat " + stream.string() + " | ");
  }
  /// Runs the program on the output of a shell's command.
  int runOf(const std::string& command, const std::string& options = "--side-by-side --camera 700,700,600,180,0.5") {
    return motorcade("run - --out " + out("refused").string() + " " + options, command + " | ");
  }
  void expectSameTables(const std::string& a, const std::string& b) {
    for (const std::string& file : kTables) {
      EXPECT_FALSE(contentOf(out(a) / file).empty()) << file;
      EXPECT_TRUE(contentOf(out(a) / file) == contentOf(out(b) / file)) << file;
    }
  }
  static std::string rendered() { return "--calibration " + (kSequence / "calib.txt").string(); }
};

TEST_F(RunStream, GivesTheSameBytesAsTheFolder) {
  ASSERT_EQ(run("folder", rendered() + " --masks"), 0) << contentOf(errors());
  const fs::path beside = streamOf(kSequence, StereoPacking::kSideBySide);
  ASSERT_EQ(runPiped("beside", beside, "--side-by-side --masks " + rendered()), 0) << contentOf(errors());
  expectSameTables("folder", "beside");
  EXPECT_EQ(contentOf(out("folder") / "outlines.jsonl"), contentOf(out("beside") / "outlines.jsonl"));
  const fs::path above = streamOf(kSequence, StereoPacking::kOverUnder);
  ASSERT_EQ(runPiped("above", above, "--over-under " + rendered()), 0) << contentOf(errors());
  expectSameTables("folder", "above");
  const auto json = summary("above");
  EXPECT_EQ(json["sequence"], "-");
  EXPECT_EQ(json["layout"], "y4m_over_under");
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["images"]["pairs"], kFrames);
  EXPECT_EQ(json["capture_rate_hz"], 10);
}

TEST_F(RunStream, GivesTheSameBytesAsTheFolderOfARealDrive) {
  const fs::path data = dataFolder() / "kitti_tracking_0003";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const fs::path drive = out("drive");  // without its times, which a stream has not
  fs::create_directories(drive);
  for (const char* part : {"image_0", "image_1", "calib.txt"})
    fs::create_symlink(fs::absolute(data) / part, drive / part);
  const std::string calibration = "--calibration " + (data / "calib.txt").string();
  ASSERT_EQ(run("folder", calibration + " --fps 10", drive), 0) << contentOf(errors());
  const fs::path stream = streamOf(drive, StereoPacking::kSideBySide);
  ASSERT_EQ(runPiped("pipe", stream, "--side-by-side " + calibration), 0) << contentOf(errors());
  expectSameTables("folder", "pipe");
}

TEST_F(RunStream, GivesTheSameBytesThroughFfmpeg) {
  if (std::system("command -v ffmpeg >/dev/null") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  const fs::path stream = out("ffmpeg.y4m");
  const auto side = [](const char* images) {
    return " -framerate 10 -i " + (kSequence / images / "%06d.png").string();
  };
  const std::string command = "ffmpeg -v error" + side("image_0") + side("image_1") +
                              " -filter_complex hstack -f yuv4mpegpipe -pix_fmt gray -strict -1 " + stream.string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  ASSERT_EQ(run("folder", rendered()), 0) << contentOf(errors());
  ASSERT_EQ(runPiped("pipe", stream, "--side-by-side " + rendered()), 0) << contentOf(errors());
  expectSameTables("folder", "pipe");
}

TEST_F(RunStream, RunsTheFramesThatAreAskedForAtThePaceThatIsAskedFor) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide, "F0:0 Cmono");
  EXPECT_EQ(runPiped("none", stream, "--side-by-side " + rendered()), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("tells no rate (F); give --fps"));
  const std::string options = "--side-by-side --fps 10 --frames 3:9 " + rendered();
  ASSERT_EQ(runPiped("pipe", stream, options + " --rate 40 --mcap " + out("drive.mcap").string()), 0)
      << contentOf(errors());
  ASSERT_EQ(run("folder", "--frames 3:9 " + rendered()), 0) << contentOf(errors());
  expectSameTables("folder", "pipe");
  EXPECT_EQ(summary("pipe")["rate"], 40);
  EXPECT_GT(fs::file_size(out("drive.mcap")), 0U);
  EXPECT_EQ(runPiped("none", stream, "--side-by-side --fps 10 --frames 50: " + rendered()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("before the first of --frames"));
}

/// However many pairs are in time. With hardly one no motion is measured, which ends a run with exit code 3.
TEST_F(RunStream, LiveTakesTheNewestPairAndCountsTheOthers) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide);
  EXPECT_THAT(runPiped("live", stream, "--side-by-side --live " + rendered()), AnyOf(0, 3)) << contentOf(errors());
  const auto frames = summary("live")["frames"];
  EXPECT_EQ(frames["received"], kFrames);
  EXPECT_EQ(frames["processed"].get<std::size_t>() + frames["dropped"].get<std::size_t>(), kFrames);
  EXPECT_EQ(summary("live")["policy"], "live");
  const RunFolder folder = readRunFolder(out("live"));
  EXPECT_EQ(folder.frames.size(), kFrames) << "each pair has its line";
  EXPECT_NE(folder.frames.back().head.status, FrameStatus::kDropped) << "the last one is the newest";
}

TEST_F(RunStream, SignalEndsTheRunWhileThePipeIsSilent) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide), fifo = out("fifo");
  ASSERT_EQ(std::system(("mkfifo " + fifo.string()).c_str()), 0);
  // The signal comes when so many frames are in their table. A shell's background has SIGINT ignored.
  const auto interrupted = [&](const std::string& signal, const std::string& written, std::size_t frames) {
    std::ostringstream command;
    command << "(" << written << "exec sleep 600) >" << fifo << " & writer=$!; env --default-signal=INT "
            << MOTORCADE_PROGRAM << " run - --side-by-side " << rendered() << " --force --out " << out(signal) << " <"
            << fifo << " >/dev/null 2>" << errors() << " & run=$!; for i in $(seq 600); do [ $(cat "
            << out(signal) / "frames.csv"
            << " 2>/dev/null | wc -l) -gt " << frames << " ] && break; sleep 0.1; done; kill -s " << signal
            << " $run; wait $run; code=$?; kill $writer; exit $code";
    return WEXITSTATUS(std::system(command.str().c_str()));
  };
  EXPECT_EQ(interrupted("INT", "cat " + stream.string() + "; ", kFrames), 130) << contentOf(errors());
  EXPECT_EQ(summary("INT")["complete"], false);
  EXPECT_EQ(summary("INT")["interrupted_by"], "SIGINT");
  EXPECT_EQ(readRunFolder(out("INT")).final.camera.size(), kFrames) << "what came before is written";
  EXPECT_EQ(interrupted("TERM", "head -c 1000000 " + stream.string() + "; ", 1), 143) << "within a picture";
  EXPECT_EQ(readRunFolder(out("TERM")).final.camera.size(), 1U);
  EXPECT_EQ(interrupted("TERM", "", 0), 143) << "before the header, where nothing is written yet";
}

TEST_F(RunStream, StreamThatIsCutShortIsToldAndEndsTheRunWell) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide);
  fs::resize_file(stream, fs::file_size(stream) - 100);
  ASSERT_EQ(runPiped("cut", stream, "--side-by-side " + rendered()), 0) << contentOf(errors());
  const std::string told = "ends within a picture, after " + std::to_string(kFrames - 1) + " pairs";
  EXPECT_THAT(contentOf(errors()), HasSubstr(told));
  EXPECT_EQ(readRunFolder(out("cut")).final.camera.size(), kFrames - 1);
  const auto json = summary("cut");
  EXPECT_EQ(json["complete"], true);
  ASSERT_EQ(json["findings"].size(), 1U);
  EXPECT_EQ(json["findings"][0]["name"], "stream");
  EXPECT_THAT(json["findings"][0]["text"].get<std::string>(), HasSubstr(told));
}

TEST_F(RunStream, DamagedStreamKeepsTheFramesBeforeAndEndsWithAnError) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide);
  std::ofstream(stream, std::ios::app) << "junk\n";
  EXPECT_EQ(runPiped("damaged", stream, "--side-by-side " + rendered()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("a frame should begin with a line FRAME"));
  EXPECT_EQ(readRunFolder(out("damaged")).final.camera.size(), kFrames);
  EXPECT_EQ(summary("damaged")["complete"], false);
}

TEST_F(RunStream, StreamsThatCannotBeUsedAreNamed) {
  EXPECT_EQ(runOf("true"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("standard input: ends before it begins"));
  EXPECT_EQ(runOf("echo nonsense"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("no YUV4MPEG2 stream, it begins with 'nonsense'"));
  EXPECT_EQ(runOf("echo YUV4MPEG2 W2485 H375 F10:1"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("2485x375, an odd width"));
  EXPECT_EQ(runOf("echo YUV4MPEG2 W2484 H375 F10:1 It"), 3);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("interlaced"), HasSubstr("--force goes on")));
  EXPECT_EQ(runOf("echo YUV4MPEG2 W2484 H375 F10:1",
                  "--side-by-side --camera 700,700,600,180,0.5 --set "
                  "input.max_pixels=10000"),
            3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("input.max_pixels is 10000"));
  EXPECT_EQ(runOf("echo YUV4MPEG2 W2484 H375 F10:1"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("the stream ends after 0 pairs"));
}

/// Options are refused before anything is read, so that nobody waits for a camera to learn of them.
TEST_F(RunStream, OptionsThatAStreamCannotMeetAreRefused) {
  const std::string camera = "--camera 700,700,600,180,0.5 ", both = camera + "--side-by-side ";
  const auto refused = [&](const std::string& options) {
    EXPECT_EQ(runOf("sleep 0", options), 2) << options;
    return contentOf(errors());
  };
  EXPECT_THAT(refused(camera), HasSubstr("--side-by-side (left | right) or --over-under"));
  EXPECT_THAT(refused(both + "--over-under"), HasSubstr("--over-under"));
  EXPECT_THAT(refused("--side-by-side"), HasSubstr("a stream brings no calibration"));
  EXPECT_THAT(refused(both + "--camera-poses x.txt"), HasSubstr("--camera-poses: needs a pose for each frame"));
  EXPECT_THAT(refused(both + "--live --rate 10"), HasSubstr("sets its pace"));
  EXPECT_THAT(refused(both + "--inject bitflips=3"), HasSubstr("--inject: faults of files"));
  EXPECT_EQ(run("folder", "--side-by-side"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("write - in place of the sequence"));
  EXPECT_EQ(motorcade("check -"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("`motorcade run` alone"));
  EXPECT_EQ(motorcade("run - --out " + out("closed").string() + " " + both + " <&-"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("standard input: is closed"));
}

TEST_F(RunStream, FaultsAreInjectedIntoAStreamToo) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide);
  const std::string faults = " --inject black@3:5,noise=5@6:8,jump=0.05@9";
  ASSERT_EQ(run("folder", rendered() + faults), 0) << contentOf(errors());
  ASSERT_EQ(runPiped("pipe", stream, "--side-by-side --ignore bottom=10 " + rendered() + faults), 0);
  ASSERT_EQ(run("ignored", "--ignore bottom=10 " + rendered() + faults), 0);
  expectSameTables("ignored", "pipe");
}

/// Labels are found by the numbers of the pairs, which count from the stream's first one.
TEST_F(RunStream, InstanceLabelsComeBesideAStreamToo) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide), labels = out("labels");
  fs::copy(kSequence / "instance", labels);
  fs::resize_file(labels / "000006.png", 60);
  const std::string options = "--frames 5:9 --instances " + labels.string() + " " + rendered();
  ASSERT_EQ(run("folder", options), 0) << contentOf(errors());
  const auto findings = summary("folder")["findings"];
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0]["text"].get<std::string>(), HasSubstr("a file of instance labels is left out"));
  ASSERT_EQ(runPiped("pipe", stream, "--side-by-side " + options), 0) << contentOf(errors());
  EXPECT_EQ(summary("pipe")["findings"], findings);
  expectSameTables("folder", "pipe");
}

TEST_F(RunStream, WhoeverNeedsTheImagesSaysThatTheyWereNotKept) {
  const fs::path stream = streamOf(kSequence, StereoPacking::kSideBySide);
  ASSERT_EQ(runPiped("pipe", stream, "--side-by-side " + rendered()), 0) << contentOf(errors());
  const std::string folder = out("pipe").string(), page = out("report.html").string();
  for (const std::string& command : {"evaluate " + folder, "view " + folder + " --view 127.0.0.1:0",
                                     "draw " + folder + " --out " + out("pictures").string(),
                                     "export " + folder + " --mcap " + out("drive.mcap").string()}) {
    EXPECT_EQ(motorcade(command), 3) << command;
    EXPECT_THAT(contentOf(errors()), HasSubstr("came through a pipe and were not kept")) << command;
  }
  ASSERT_EQ(motorcade("report " + folder + " --out " + page), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(page), HasSubstr("came through a pipe and were not kept"));
  EXPECT_EQ(evaluate("pipe")["final"]["frames"], kFrames) << "with --sequence";
}

}  // namespace
}  // namespace motorcade::test
