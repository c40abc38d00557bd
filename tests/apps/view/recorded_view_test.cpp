#include "apps/view/recorded_view.hpp"

#include <memory>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/measures/evaluation.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"
#include "tests/apps/program_run.hpp"

namespace motorcade::test {
namespace {

using nlohmann::json;

/// A run that is over, as the page gets it.
class ViewOfARun : public Run {
 protected:
  std::unique_ptr<RecordedView> view(const std::string& name, const SE3& T_shown_run = SE3()) const {
    const RunFolder run = readRunFolder(out(name));
    return std::make_unique<RecordedView>(run, openSequenceOf(run, {}), T_shown_run);
  }
  static json overviewOf(const RecordedView& view) { return json::parse(view.overviewJson()); }
  static json frameOf(const PageSource& view, std::int64_t frame) { return json::parse(view.frameJson(frame)); }
};

TEST_F(ViewOfARun, TheOverviewHasAValuePerFrameAndEveryTrack) {
  ASSERT_EQ(run("drive"), 0);
  const auto shown = view("drive");
  const json overview = overviewOf(*shown);
  EXPECT_EQ(overview["frames"], kFrames);
  EXPECT_EQ(overview["path"].size(), 3 * kFrames);
  EXPECT_EQ(overview["time_ms"].size(), kFrames);
  EXPECT_EQ(overview["timing"]["frames"], kFrames) << "percentiles are of the whole run, whichever frame is shown";
  EXPECT_GE(overview["timing"]["p99"], overview["timing"]["p50"]);
  std::set<std::int64_t> tracks;
  std::size_t rows = 0, covered = 0;
  for (const auto& row : readRunFolder(out("drive")).final.objects) {
    tracks.insert(row.object.track.value);
    ++rows;
  }
  for (const json& track : overview["tracks"]) {
    EXPECT_TRUE(tracks.erase(track["id"].get<std::int64_t>()));
    for (const json& span : track["spans"]) covered += span[1].get<std::size_t>() - span[0].get<std::size_t>() + 1;
  }
  EXPECT_TRUE(tracks.empty());
  EXPECT_EQ(covered, rows);
}

TEST_F(ViewOfARun, TheErrorsAreThoseOfEvaluate) {
  ASSERT_EQ(run("drive"), 0);
  EvaluateOptions options;
  options.run = out("drive");
  const Evaluation evaluation = evaluateRun(options);
  const auto shown = view("drive");
  const json overview = overviewOf(*shown), &truth = overview["truth"];
  EXPECT_NEAR(truth["ate_m"], evaluation.final.camera->ate_m.rmse, 1e-4);
  ASSERT_FALSE(evaluation.worst.camera.empty());
  const CameraFrameError& worst = evaluation.worst.camera.front();
  EXPECT_EQ(overview["worst"]["camera"][0]["frame"], worst.frame.value);
  const json frame = frameOf(*shown, worst.frame.value);
  EXPECT_NEAR(frame["truth"]["step_m"], worst.rpe_t_m, 1e-5);
  EXPECT_NEAR(frame["truth"]["step_deg"], worst.rpe_r_deg, 1e-4);
  EXPECT_NEAR(truth["step_m"][static_cast<std::size_t>(worst.frame.value)], worst.rpe_t_m, 1e-4);
  const ObjectFrameError& object = evaluation.worst.objects.front();
  EXPECT_EQ(overview["worst"]["objects"][0]["frame"], object.frame.value);
  double motion_m = -1;
  const json of_object = frameOf(*shown, object.frame.value);
  for (const json& label : of_object["truth"]["objects"])
    if (label["id"] == object.label) motion_m = label.value("motion_m", -1.0);
  EXPECT_NEAR(motion_m, object.me_t_m, 1e-4);
  EXPECT_EQ(truth["labels"].size(), evaluation.final.objects.size());
}

TEST_F(ViewOfARun, WorstFramesAreApart) {
  ASSERT_EQ(run("drive"), 0);
  const json worst = overviewOf(*view("drive"))["worst"];
  for (const char* kind : {"camera", "objects", "late"}) {
    std::int64_t last = -100;
    std::set<std::int64_t> frames;
    for (const json& entry : worst[kind]) frames.insert(entry["frame"].get<std::int64_t>());
    for (const std::int64_t frame : frames) {
      EXPECT_GE(frame - last, 5) << kind;
      last = frame;
    }
  }
}

TEST_F(ViewOfARun, LostAndRejectedFramesAreMarked) {
  ASSERT_EQ(run("drive", "", damagedSequence()), 0);
  const json marks = overviewOf(*view("drive"))["marks"];
  ASSERT_FALSE(marks.empty());
  EXPECT_EQ(marks[0]["from"], 3);
  EXPECT_EQ(marks[0]["to"], 3);
  EXPECT_EQ(marks[0]["status"], "rejected");
  EXPECT_EQ(marks[0]["cause"], "unusable");
}

TEST_F(ViewOfARun, WithoutTruthThereAreNoErrors) {
  fs::copy(kSequence, out("bare"), fs::copy_options::recursive);
  for (const char* file : {"poses.txt", "label_02.txt", "object_poses.txt"}) fs::remove(out("bare") / file);
  ASSERT_EQ(run("drive", "", out("bare")), 0);
  const auto shown = view("drive");
  const json overview = overviewOf(*shown);
  EXPECT_FALSE(overview.contains("truth"));
  EXPECT_TRUE(overview["worst"]["camera"].empty());
  EXPECT_FALSE(overview["worst"]["late"].empty());
  EXPECT_FALSE(frameOf(*shown, 5).contains("truth"));
}

TEST_F(ViewOfARun, AnotherRunIsShownInTheSameWorld) {
  ASSERT_EQ(run("whole"), 0);
  ASSERT_EQ(run("later", "--frames 4:14"), 0);
  const RunFolder whole = readRunFolder(out("whole")), later = readRunFolder(out("later"));
  EXPECT_LT(worldOfOther(whole, whole).translation().norm(), 1e-12);
  auto shown = view("whole");
  shown->compareWith(view("later", worldOfOther(whole, later)));
  EXPECT_EQ(shown->run().against, out("later").string());
  ASSERT_NE(shown->against(), nullptr);
  const json ours = frameOf(*shown, 4), theirs = frameOf(*shown->against(), 4);
  for (const int i : {3, 7, 11})
    EXPECT_NEAR(ours["T"][i], theirs["T"][i], 2e-3) << "they meet in their first common frame";
  const json far = frameOf(*shown, 13), other = frameOf(*shown->against(), 13);
  EXPECT_GT(std::abs(far["T"][11].get<double>()), 1) << "the camera drives";
  EXPECT_NEAR(far["T"][11], other["T"][11], 0.3);
  EXPECT_NEAR(far["truth"]["T"][11], other["truth"]["T"][11], 0.3) << "the truth moves with its run";
}

TEST_F(ViewOfARun, RunsWithoutACommonFrameAreRefused) {
  ASSERT_EQ(run("early", "--frames 0:6"), 0);
  ASSERT_EQ(run("late", "--frames 8:14"), 0);
  EXPECT_THROW(worldOfOther(readRunFolder(out("early")), readRunFolder(out("late"))), InputError);
  EXPECT_EQ(motorcade("view " + out("early").string() + " --against " + out("late").string() + " --view 127.0.0.1:0"),
            3);
  EXPECT_THAT(contentOf(errors()), testing::HasSubstr("no frame in common"));
}

}  // namespace
}  // namespace motorcade::test
