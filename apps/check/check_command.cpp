#include "apps/check/check_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/check/check_page.hpp"
#include "apps/check/finding_guide.hpp"
#include "apps/check/sequence_remarks.hpp"
#include "apps/inject/fault_injector.hpp"
#include "apps/watch/frozen_camera.hpp"
#include "apps/watch/input_check.hpp"
#include "apps/watch/own_vehicle_search.hpp"
#include "apps/watch/vehicle_news.hpp"
#include "io/files/json_text.hpp"
#include "io/files/line_file.hpp"
#include "io/inputs/sequence_decoder.hpp"
#include "io/layouts/open_sequence.hpp"

namespace motorcade {
namespace {

constexpr int kExitInput = 3;
constexpr std::size_t kShownPairs = 3;

/// Counts of the pairs that came, and of those that cannot be used.
struct Seen {
  std::size_t pairs = 0, unusable = 0;
  std::string first_problem;
  std::vector<StereoFrame> kept;  // with their images, where a page needs them
  std::optional<OwnVehicleView> own_vehicle;
  std::optional<FrozenCamera::Side> frozen;

  void count(const StereoFrame& pair) {
    ++pairs;
    if (isWhole(pair)) return;
    ++unusable;
    if (first_problem.empty()) first_problem = pair.rejected() ? pair.problem : "an image is missing";
  }
};

/// Shows the first pairs of the sequence to the check, after faults were injected.
Seen look(InputCheck& check, const Sequence& sequence, const CheckOptions& options) {
  const FrameRange range = selectedFrames(options.frames, sequence);
  FaultInjector faults(parseFaultSpec(options.inject), sequence);
  OwnVehicleSearch own_vehicle(sequence.camera);
  FrozenCamera frozen_camera;
  Seen seen;
  FrameId passed_over;  // the last one; what comes of it or of one before is late, and a run ignores it
  const FaultInjector::Outlet outlet{.push =
                                         [&](const StereoFrame& pair) {
                                           if (pair.head.frame <= passed_over) return true;
                                           seen.count(pair);
                                           const std::size_t before = check.pairs();
                                           check.observe(pair);
                                           if (isWhole(pair)) {
                                             own_vehicle.observe(pair);
                                             if (auto side = frozen_camera.observe(pair)) seen.frozen = side;
                                           }
                                           if (!options.page.empty() && check.pairs() > before)
                                             seen.kept.push_back(pair);
                                           return !check.complete();
                                         },
                                     .pass_over = [&](FrameId frame, Timestamp) { passed_over = frame; },
                                     .wait = [](std::chrono::duration<double>) {}};
  SequenceDecoder decoder(sequence, range, {});
  bool wanted = true;
  while (auto pair = wanted ? decoder.next() : std::nullopt) wanted = faults.give(std::move(*pair), outlet);
  if (wanted) faults.finish(outlet);
  seen.own_vehicle = own_vehicle.found();
  return seen;
}

/// A finding if the own vehicle hides much of the view ahead.
std::optional<Finding> ownVehicleFinding(const std::optional<OwnVehicleView>& view) {
  constexpr double kMuch = 0.1;  // of the image
  if (!view || view->share <= kMuch) return std::nullopt;
  return Finding{"own_vehicle",
                 "the own vehicle " + placeOf(*view) +
                     ", where nothing is followed; the near road is what tells distances best: mount the cameras "
                     "higher, farther ahead or tilted up",
                 false};
}

/// All findings. Without any usable pair nothing else is known.
std::vector<Finding> findingsOf(const InputCheck& check, const Seen& seen, const Sequence& sequence,
                                const FrameRange& range) {
  constexpr std::size_t kMosaicPairs = 3;
  std::vector<Finding> findings;
  for (const std::string& doubt : doubtsAbout(sequence.camera)) findings.push_back({"calibration", doubt, true});
  for (const std::string& oddity : odditiesOf(sequence.camera)) findings.push_back({"camera", oddity, false});
  if (const auto doubt = mosaicDoubt(sequence, range, kMosaicPairs)) findings.push_back({"mosaic", *doubt, false});
  if (const auto hidden = ownVehicleFinding(seen.own_vehicle)) findings.push_back(*hidden);
  if (seen.frozen) findings.push_back(findingOf(*seen.frozen));
  for (const InputNote& note : sequence.notes) findings.push_back({note.name, note.text, note.worthless});
  if (seen.unusable == seen.pairs)
    findings.push_back({"images",
                        "none of " + std::to_string(seen.pairs) + " pairs can be used" +
                            (seen.first_problem.empty() ? "" : ": " + seen.first_problem),
                        true});
  for (Finding& finding : check.findings()) findings.push_back(std::move(finding));
  return findings;
}

/// Those whose rows agree least.
std::vector<MatchedPair> worstPairs(const InputCheck& check, const std::vector<StereoFrame>& kept) {
  std::vector<MatchedPair> pairs;
  for (const LookedAt& look : check.looks()) {
    const auto images = std::ranges::find(kept, look.frame, [](const StereoFrame& frame) { return frame.head.frame; });
    if (images != kept.end() && !look.matches.empty())
      pairs.push_back({look.frame, images->left, images->right, look.matches});
  }
  std::ranges::stable_sort(pairs, std::ranges::greater{},
                           [](const MatchedPair& pair) { return rowRms_px(pair.matches); });
  if (pairs.size() > kShownPairs) pairs.resize(kShownPairs);
  return pairs;
}

void printGeometry(const PairGeometry& geometry) {
  std::printf("rows of left and right image, from %zu points seen in both:\n", geometry.matches);
  std::printf("  %-18s %10s %10s %12s\n", "", "measured", "sigma", "effect [px]");
  for (std::size_t k = 0; k < kRowErrors; ++k) {
    const RowErrorEstimate& error = geometry.errors[k];
    const RowErrorName& name = kRowErrorNames[k];
    std::printf("  %-18s %10.3f %10.3f %12.2f\n", name.title, name.unit * error.value, name.unit * error.sigma,
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
    json["row_errors"][kRowErrorNames[k].key] = {
        {"value", error.value}, {"sigma", error.sigma}, {"effect_px", error.effect_px}};
  }
  json["run_refuses"] = isWorthless(findings);
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : findings)
    json["findings"].push_back({{"name", finding.name}, {"worthless", finding.worthless}, {"text", finding.text}});
  writeAtOnce(file, jsonText(json, 2) + "\n");
}

void printFindings(const std::vector<Finding>& findings, const CheckOptions& options) {
  for (const Finding& finding : findings)
    std::printf("%s (%s): %s\n", finding.worthless ? "worthless" : "warning", finding.name.c_str(),
                finding.text.c_str());
  if (findings.empty()) std::printf("nothing is wrong\n");
  std::printf("%s\n", verdictOnRun(findings).c_str());
  if (!options.page.empty())
    std::printf("page        %s\n", options.page.string().c_str());
  else if (!findings.empty())
    std::printf("--page FILE.html shows it in pictures, and says more on how to mend it\n");
}

}  // namespace

int runCheck(const CheckOptions& options) {
  const Sequence sequence = openSequence(options.sequence, options.fps_hz, options.given);
  const FrameRange range = selectedFrames(options.frames, sequence);
  std::puts(sequenceLine(sequence, range).c_str());
  InputCheck check(sequence.camera);
  const Seen seen = look(check, sequence, options);
  const PairGeometry geometry = check.geometry();
  const std::vector<Finding> findings = findingsOf(check, seen, sequence, range);
  if (!options.json.empty()) writeJson(options.json, geometry, findings);
  if (!options.page.empty())
    writeAtOnce(options.page, checkPage({options.sequence.string(), sequence.camera, &check, findings,
                                         worstPairs(check, seen.kept)}));
  printGeometry(geometry);
  printFindings(findings, options);
  return isWorthless(findings) ? kExitInput : 0;
}

}  // namespace motorcade
