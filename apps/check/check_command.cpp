#include "apps/check/check_command.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <numbers>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/check/camera_doubts.hpp"
#include "apps/check/input_check.hpp"
#include "apps/inject/fault_injector.hpp"
#include "io/line_file.hpp"
#include "io/sequence.hpp"
#include "io/sequence_decoder.hpp"

namespace motorcade {
namespace {

constexpr int kExitInput = 3;
constexpr std::array<const char*, kRowErrors> kNames{"row offset [px]", "roll [deg]",       "zoom [%]",     "yaw [deg]",
                                                     "lift / baseline", "ahead / baseline", "distortion k1"};
constexpr std::array<const char*, kRowErrors> kKeys{"rows_px", "roll_rad", "zoom", "yaw_rad", "lift", "ahead", "k1"};
constexpr double kDegree = 180 / std::numbers::pi;
constexpr std::array<double, kRowErrors> kUnits{1, kDegree, 100, kDegree, 1, 1, 1};

/// Shows the first pairs of the sequence, after faults, to the check.
InputCheck lookedAt(const Sequence& sequence, const CheckOptions& options) {
  const FrameRange range = selectedFrames(options.frames, sequence);
  InputCheck check(sequence.camera);
  FaultInjector faults(parseFaultSpec(options.inject), sequence);
  const FaultInjector::Outlet outlet{.push =
                                         [&check](const StereoFrame& pair) {
                                           check.observe(pair);
                                           return !check.complete();
                                         },
                                     .pass_over = [](FrameId, Timestamp) {},
                                     .wait = [](std::chrono::duration<double>) {}};
  SequenceDecoder decoder(sequence, range, {});
  while (auto pair = decoder.next())
    if (!faults.give(std::move(*pair), outlet)) break;
  return check;
}

void printGeometry(const PairGeometry& geometry) {
  std::printf("rows of left and right image, from %zu points seen in both:\n", geometry.matches);
  std::printf("  %-18s %10s %10s %12s\n", "", "measured", "sigma", "effect [px]");
  for (std::size_t k = 0; k < kRowErrors; ++k) {
    const RowErrorEstimate& error = geometry.errors[k];
    std::printf("  %-18s %10.3f %10.3f %12.2f\n", kNames[k], kUnits[k] * error.value, kUnits[k] * error.sigma,
                error.effect_px);
  }
  std::printf(
      "  the rows differ by %.2f px (root mean square); %.0f %% of the points follow the errors above to %.2f px\n",
      geometry.rms_px, 100 * geometry.agreeing_share, geometry.remaining_px);
}

void writeJson(const std::filesystem::path& file, const PairGeometry& geometry, const std::vector<Finding>& findings) {
  nlohmann::ordered_json json;
  json["points"] = geometry.matches;
  json["rms_px"] = geometry.rms_px;
  for (std::size_t k = 0; k < kRowErrors; ++k) {
    const RowErrorEstimate& error = geometry.errors[k];
    json["row_errors"][kKeys[k]] = {{"value", error.value}, {"sigma", error.sigma}, {"effect_px", error.effect_px}};
  }
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : findings)
    json["findings"].push_back({{"name", finding.name}, {"worthless", finding.worthless}, {"text", finding.text}});
  writeAtOnce(file, json.dump(2) + "\n");
}

}  // namespace

int runCheck(const CheckOptions& options) {
  const Sequence sequence = openSequence(options.sequence, options.fps_hz, options.given);
  const InputCheck check = lookedAt(sequence, options);
  const PairGeometry geometry = check.geometry();
  std::vector<Finding> findings;
  for (const std::string& doubt : doubtsAbout(sequence.camera)) findings.push_back({"calibration", doubt, true});
  for (Finding& finding : check.findings()) findings.push_back(std::move(finding));
  printGeometry(geometry);
  bool worthless = false;
  for (const Finding& finding : findings) {
    worthless = worthless || finding.worthless;
    std::printf("%s (%s): %s\n", finding.worthless ? "worthless" : "warning", finding.name.c_str(),
                finding.text.c_str());
  }
  if (findings.empty()) std::printf("nothing is wrong\n");
  if (!options.json.empty()) writeJson(options.json, geometry, findings);
  return worthless ? kExitInput : 0;
}

}  // namespace motorcade
