#include "apps/check/check_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/check/camera_doubts.hpp"
#include "apps/check/check_page.hpp"
#include "apps/check/input_check.hpp"
#include "apps/check/mosaic_doubt.hpp"
#include "apps/check/row_error_names.hpp"
#include "apps/check/sequence_line.hpp"
#include "apps/inject/fault_injector.hpp"
#include "io/line_file.hpp"
#include "io/sequence.hpp"
#include "io/sequence_decoder.hpp"

namespace motorcade {
namespace {

constexpr int kExitInput = 3;
constexpr std::size_t kShownPairs = 3;

bool isWhole(const StereoFrame& pair) { return !pair.rejected() && !pair.left.empty() && !pair.right.empty(); }

/// Shows the first pairs of the sequence, after faults, to the check, and keeps their images where a page needs them.
void look(InputCheck& check, std::vector<StereoFrame>& kept, const Sequence& sequence, const CheckOptions& options) {
  const FrameRange range = selectedFrames(options.frames, sequence);
  FaultInjector faults(parseFaultSpec(options.inject), sequence);
  const FaultInjector::Outlet outlet{.push =
                                         [&](const StereoFrame& pair) {
                                           check.observe(pair);
                                           if (!options.page.empty() && isWhole(pair)) kept.push_back(pair);
                                           return !check.complete();
                                         },
                                     .pass_over = [](FrameId, Timestamp) {},
                                     .wait = [](std::chrono::duration<double>) {}};
  SequenceDecoder decoder(sequence, range, {});
  while (auto pair = decoder.next())
    if (!faults.give(std::move(*pair), outlet)) break;
}

/// Those whose rows agree least.
std::vector<MatchedPair> worstPairs(const InputCheck& check, const std::vector<StereoFrame>& kept) {
  std::vector<MatchedPair> pairs;
  for (const LookedAt& look : check.looks()) {
    const auto images = std::ranges::find(kept, look.frame, &StereoFrame::frame);
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
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : findings)
    json["findings"].push_back({{"name", finding.name}, {"worthless", finding.worthless}, {"text", finding.text}});
  writeAtOnce(file, json.dump(2) + "\n");
}

/// Gives whether results would be worthless.
bool printFindings(const std::vector<Finding>& findings, const CheckOptions& options) {
  bool worthless = false;
  for (const Finding& finding : findings) {
    worthless = worthless || finding.worthless;
    std::printf("%s (%s): %s\n", finding.worthless ? "worthless" : "warning", finding.name.c_str(),
                finding.text.c_str());
  }
  if (findings.empty()) std::printf("nothing is wrong\n");
  if (!options.page.empty())
    std::printf("page        %s\n", options.page.string().c_str());
  else if (!findings.empty())
    std::printf("--page FILE.html shows it in pictures, and says more on how to mend it\n");
  return worthless;
}

}  // namespace

int runCheck(const CheckOptions& options) {
  const Sequence sequence = openSequence(options.sequence, options.fps_hz, options.given);
  std::puts(sequenceLine(sequence, selectedFrames(options.frames, sequence)).c_str());
  InputCheck check(sequence.camera);
  std::vector<StereoFrame> kept;
  look(check, kept, sequence, options);
  const PairGeometry geometry = check.geometry();
  std::vector<Finding> findings;
  for (const std::string& doubt : doubtsAbout(sequence.camera)) findings.push_back({"calibration", doubt, true});
  for (const std::string& oddity : odditiesOf(sequence.camera)) findings.push_back({"camera", oddity, false});
  if (const auto doubt = mosaicDoubt(sequence, selectedFrames(options.frames, sequence), 3))
    findings.push_back({"mosaic", *doubt, false});
  for (const InputNote& note : sequence.notes) findings.push_back({note.name, note.text, note.worthless});
  for (Finding& finding : check.findings()) findings.push_back(std::move(finding));
  if (check.matches().size() < InputCheck::kFewestMatches)
    findings.push_back({"points",
                        "only " + std::to_string(check.matches().size()) +
                            " points are seen in both images: nothing can be told of their rows; look at the images",
                        false});
  if (!options.json.empty()) writeJson(options.json, geometry, findings);
  if (!options.page.empty())
    writeAtOnce(options.page,
                checkPage({options.sequence.string(), sequence.camera, &check, findings, worstPairs(check, kept)}));
  printGeometry(geometry);
  return printFindings(findings, options) ? kExitInput : 0;
}

}  // namespace motorcade
