#include "apps/recorded/recorded_run.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/files/errors.hpp"
#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"
#include "io/layouts/open_sequence.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kUsualRate_hz = 10;

/// The summary, or an object without keys if there is none that can be read.
Json summaryOf(const RunFolder& run) {
  Json json = jsonOrDiscarded(run.summary_json);
  return json.is_object() ? json : Json::object();
}

std::string textOf(const Json& summary, const char* key) {
  const auto found = summary.find(key);
  return found != summary.end() && found->is_string() ? found->get<std::string>() : "";
}

fs::path recordedFolder(const RunFolder& run, const Json& summary) {
  const fs::path file = run.folder / "summary.json";
  const std::string folder = textOf(summary, "sequence");
  if (folder.empty())
    throw InputError(file.string() + (run.complete() ? ": does not name" : ": is not there to name") +
                     " the sequence that was run; give --sequence");
  if (folder == kStandardInput)
    throw InputError(run.folder.string() +
                     ": its images came through a pipe and were not kept; if they are also in a folder, name it with "
                     "--sequence");
  if (textOf(summary, "layout") == kBagLayout)
    throw InputError(run.folder.string() + ": its images are in the bag " + folder +
                     ", which `run` alone reads; if they are also in a folder, name it with --sequence");
  std::error_code unreachable;  // is as if it were not there
  if (!fs::exists(folder, unreachable))
    throw InputError(file.string() + ": names the sequence " + folder +
                     ", which is not there; say with --sequence where it is");
  return folder;
}

/// Camera options that the user gave. A calibration found in the sequence is left out, as it is found again.
GivenCameras givenCamerasOf(const Json& summary) {
  const bool found = textOf(summary, "calibration_from") == "sequence";
  return {textOf(summary, "camera"), found ? "" : textOf(summary, "calibration"), textOf(summary, "bayer")};
}

double recordedRate_hz(const Json& summary) {
  const auto found = summary.find("capture_rate_hz");
  const double rate_hz = found != summary.end() && found->is_number() ? found->get<double>() : 0;
  return rate_hz > 0 ? rate_hz : kUsualRate_hz;
}

/// One behind the last frame of the run, as numbered in the sequence.
std::int64_t endOf(const RunFolder& run) {
  const auto poses = std::max(run.online.camera.size(), run.final.camera.size());
  std::int64_t end = run.first_frame + static_cast<std::int64_t>(poses);
  for (const auto& row : run.frames) end = std::max(end, row.head.frame.value + 1);
  return end;
}

bool timesAreTheCameras(const Json& summary) {
  return !summary.empty() && textOf(summary, "inject").find("jump") == std::string::npos;
}

/// Time from the frame to one beside it.
std::int64_t interval_ns(const Sequence& sequence, std::size_t frame) {
  if (sequence.stamps.size() < 2) return 0;
  const std::size_t earlier = std::max<std::size_t>(frame, 1) - 1;
  return sequence.stamps[earlier + 1].ns - sequence.stamps[earlier].ns;
}

/// True when most frames of the run have the capture times of the sequence's frames.
bool timesFit(const RunFolder& run, const Sequence& sequence) {
  std::int64_t compared = 0, fitting = 0;
  for (const auto& row : run.frames) {
    if (row.head.frame.value < 0 || row.head.cause == FrameCause::kOutOfOrder) continue;  // that has an expected time
    const auto frame = static_cast<std::size_t>(row.head.frame.value);
    const auto difference_ns = static_cast<double>(row.head.stamp.ns) - static_cast<double>(sequence.stamps[frame].ns);
    ++compared;
    fitting += std::abs(difference_ns) <= 0.5 * static_cast<double>(interval_ns(sequence, frame));
  }
  return 2 * fitting >= compared;
}

}  // namespace

bool holdsFinishedRun(const fs::path& folder) {
  const fs::path file = folder / "summary.json";
  std::error_code unreachable;  // then nothing can be replaced there either
  if (!fs::exists(file, unreachable)) return false;
  const Json summary = jsonOrDiscarded(readWhole(file));
  return !summary.is_object() || summary.value("complete", Json(true)) != Json(false);
}

bool wasPaced(const RunFolder& run) {
  const Json summary = summaryOf(run);
  const auto rate = summary.find("rate");
  return rate != summary.end() && rate->is_number();
}

Sequence openSequenceOf(const RunFolder& run, const NamedSequence& named) {
  const Json summary = summaryOf(run);
  const fs::path folder = named.folder.empty() ? recordedFolder(run, summary) : named.folder;
  const GivenCameras given = givenCamerasOf(summary);
  Sequence sequence = openSequence(folder, named.fps_hz.value_or(recordedRate_hz(summary)), given);
  requireSameDrive(run, sequence);
  return sequence;
}

void requireSameDrive(const RunFolder& run, const Sequence& sequence) {
  const std::string other = run.folder.string() + ": is no run of " + sequence.folder.string() + ": ";
  const auto frames = static_cast<std::int64_t>(sequence.frames.size());
  if (endOf(run) > frames)
    throw InputError(other + "it has frames up to " + std::to_string(endOf(run) - 1) + ", the sequence has " +
                     std::to_string(frames));
  if (!timesAreTheCameras(summaryOf(run)) || timesFit(run, sequence)) return;
  throw InputError(other + "most of its frames have other times than the sequence's" +
                   (sequence.stamps_measured ? "" : ", which come from the frame rate; is it --fps?"));
}

std::size_t recoverFinals(RunFolder& run) {
  std::vector<SE3>& camera = run.final.camera;
  const std::size_t known = camera.size(), all = run.online.camera.size();
  if (known >= all) return 0;
  const SE3 T_final_online = known > 0 ? camera.back() * run.online.camera[known - 1].inverse() : SE3();
  for (std::size_t i = known; i < all; ++i) camera.push_back((T_final_online * run.online.camera[i]).normalized());

  const auto at = [&run](std::size_t frames) { return FrameId{run.first_frame + static_cast<std::int64_t>(frames)}; };
  const auto isUnknown = [&](const auto& row) { return row.frame >= at(known); };
  std::erase_if(run.final.objects, isUnknown);
  for (RunFolder::ObjectRow row : run.online.objects) {
    if (row.frame < at(known) || row.frame >= at(all)) continue;
    row.object.T_world_body = (T_final_online * row.object.T_world_body).normalized();
    row.object.velocity_world_mps = T_final_online.rotation() * row.object.velocity_world_mps;
    run.final.objects.push_back(row);
  }
  for (auto rows : {&RunFolder::Trajectories::covariances, &RunFolder::Trajectories::pose_covariances}) {
    std::erase_if(run.final.*rows, isUnknown);
    std::ranges::copy_if(run.online.*rows, std::back_inserter(run.final.*rows), isUnknown);
  }
  return all - known;
}

}  // namespace motorcade
