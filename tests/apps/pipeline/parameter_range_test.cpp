#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "io/files/errors.hpp"
#include "tests/apps/pipeline/toy_stages.hpp"
#include "tests/apps/rendered_drive.hpp"

/// Every key of the configuration at both ends of its range, on a short rendered drive behind another car that the
/// build's test fixture makes; and just outside of it.
namespace motorcade {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kTravel_m = 16.08;  // of the camera along its first view, by the truth

std::string numberText(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

/// The values to try: both ends of a range, or every choice.
std::vector<std::string> extremesOf(const Parameter& parameter) {
  if (const auto* choice = std::get_if<Choice>(&parameter.value)) return choice->names;
  if (std::holds_alternative<bool*>(parameter.value)) return {"false", "true"};
  return {numberText(parameter.range.least), numberText(parameter.range.most)};
}

/// Numbers that must be refused: just outside the range, and what lies outside of every range.
std::vector<std::string> outsidersOf(const Parameter& parameter) {
  const auto [least, most] = parameter.range;
  if (std::holds_alternative<int*>(parameter.value))
    return {numberText(least - 1), numberText(most + 1), "1.5", "1e300", "inf"};
  const double margin = 1e-6 * (most - least);
  return {numberText(least - margin), numberText(most + margin), "1e300", "-1e300", "inf", "-inf", "nan", "1e-310"};
}

/// Objects in the final estimates of all frames.
std::size_t objectRows(const Outcome& run) {
  std::size_t rows = 0;
  for (const FrameEstimate& estimate : run.finals) rows += estimate.objects.size();
  return rows;
}

std::size_t goodFrames(const Outcome& run) {
  return std::ranges::count(run.results, FrameStatus::kGood,
                            [](const PipelineResult& result) { return result.online.head.status; });
}

class ParameterRange : public testing::TestWithParam<std::string> {
 protected:
  Parameter parameter() {
    for (const auto& known : parameterTable(config_))
      if (known.key() == GetParam()) return known.parameter;
    throw std::logic_error("no such key");
  }

  PipelineConfig config_;
};

std::vector<std::string> allKeys() {
  PipelineConfig config;
  std::vector<std::string> keys;
  for (const auto& known : parameterTable(config)) keys.push_back(known.key());
  return keys;
}

INSTANTIATE_TEST_SUITE_P(OfEveryKey, ParameterRange, testing::ValuesIn(allKeys()), [](const auto& instance) {
  std::string name = instance.param;
  std::ranges::replace(name, '.', '_');
  return name;
});

/// A value that is legal does not make the result worthless: the camera is followed, and the car ahead is found.
TEST_P(ParameterRange, FollowsCameraAndCarAtBothEnds) {
  const Drive drive = readDrive(MOTORCADE_SMALL_SEQUENCE);
  for (const std::string& value : extremesOf(parameter())) {
    SCOPED_TRACE(GetParam() + "=" + value);
    PipelineConfig config;
    applyAssignment(config, GetParam() + "=" + value);
    Pipeline pipeline(config.pipeline, makeStages(config, drive.camera));
    const Outcome run = runThrough(pipeline, drive.frames);
    EXPECT_EQ(run.finals.size(), drive.frames.size());
    for (const PipelineResult& result : run.results) EXPECT_EQ(result.problem, "");
    if (config.pipeline.policy == InputPolicy::kLive) continue;  // drops most of the pairs, which all come at once
    EXPECT_GT(10 * goodFrames(run), 9 * drive.frames.size());
    EXPECT_GT(2 * objectRows(run), drive.frames.size());
    EXPECT_NEAR(run.finals.back().T_world_cam.translation().z(), kTravel_m, 0.02 * kTravel_m);
  }
}

/// No values exclude each other: every frame comes out, and nothing fails.
TEST(ParameterRanges, AllKeysAtTheSameEndAtOnce) {
  constexpr std::size_t kFew = 6;  // the upper ends are slow
  Drive drive = readDrive(MOTORCADE_SMALL_SEQUENCE);
  drive.frames.resize(kFew);
  for (const std::string kind : {"joint", "pose_graph", "filter", "filter_map"}) {
    for (const bool upper : {false, true}) {
      SCOPED_TRACE(kind + (upper ? " at the upper ends" : " at the lower ends"));
      PipelineConfig config, defaults;
      for (const auto& known : parameterTable(defaults)) {
        if (known.key() == "pipeline.policy") continue;  // live drops most of the pairs
        const auto values = extremesOf(known.parameter);
        applyAssignment(config, known.key() + "=" + (upper ? values.back() : values.front()));
      }
      applyAssignment(config, "backend.kind=" + kind);
      Pipeline pipeline(config.pipeline, makeStages(config, drive.camera));
      const Outcome run = runThrough(pipeline, drive.frames);
      EXPECT_EQ(run.finals.size(), drive.frames.size());
      for (const PipelineResult& result : run.results) EXPECT_EQ(result.problem, "");
    }
  }
}

TEST_P(ParameterRange, RefusesWhatLiesOutside) {
  const Parameter known = parameter();
  if (std::holds_alternative<bool*>(known.value) || std::holds_alternative<Choice>(known.value)) GTEST_SKIP();
  for (const std::string& value : outsidersOf(known)) {
    SCOPED_TRACE(value);
    try {
      applyAssignment(config_, GetParam() + "=" + value);
      ADD_FAILURE() << "was accepted";
    } catch (const UsageError& error) {
      EXPECT_EQ(error.exitCode(), 2);
      EXPECT_THAT(error.what(), AllOf(HasSubstr("'" + GetParam() + "'"), HasSubstr(known.allowed())));
    }
  }
}

}  // namespace
}  // namespace motorcade
