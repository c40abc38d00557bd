#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/recorded/recorded_drive.hpp"
#include "apps/view/page_source.hpp"
#include "apps/view/run_truth.hpp"
#include "apps/view/sequence_pictures.hpp"
#include "apps/view/shown_frame.hpp"

namespace motorcade {

// Further files of a run folder, by frame.

/// The lines of `outlines.jsonl`; none where the run did not write them.
std::map<std::int64_t, std::vector<std::string>> readOutlineLines(const std::filesystem::path& run_folder);
/// The outline of a line; a damaged line has no polygons. Does not throw.
ShownOutline outlineOf(const std::string& line);

/// A run that is over, for the page.
class RecordedView : public PageSource {
 public:
  /// Shows the run in another world by `T_shown_run`, that of the run with which it is compared. Throws InputError
  /// naming the file that cannot be read.
  RecordedView(const RunFolder& run, const Sequence& sequence, const SE3& T_shown_run = SE3());

  /// Shows another run of the same drive beside this one.
  void compareWith(std::unique_ptr<const RecordedView> other);

  ShownRun run() const override { return run_; }
  RunSnapshot snapshot() const override;
  std::string framesJson(std::int64_t from, std::size_t count) const override;
  std::string frameJson(std::int64_t frame) const override;
  std::string overviewJson() const override { return overview_json_; }
  const PageSource* against() const override { return against_.get(); }
  std::shared_ptr<const std::string> picture(std::int64_t frame) override { return pictures_.jpeg(frame); }
  bool control(const std::string& /*action*/) override { return false; }

 private:
  bool has(std::int64_t frame) const { return frame >= run_.first_frame && frame < run_.end_frame; }
  ShownFrame shown(std::int64_t frame, FrameDetail detail) const;
  void describe(const RunFolder& run, const Sequence& sequence);
  void countFrames(const RunFolder& run);
  std::optional<ShownTruth> truthOf(std::int64_t frame) const;

  ShownRun run_;
  RecordedDrive drive_;
  std::optional<RunTruth> truth_;
  std::map<std::int64_t, FrameRow> rows_;
  std::map<std::int64_t, std::vector<std::string>> outlines_;  // lines of outlines.jsonl
  std::map<std::int64_t, RoadPlane> roads_;
  RunCounts counts_;
  SequencePictures pictures_;
  std::string overview_json_;
  std::unique_ptr<const RecordedView> against_;
};

/// The transform that brings another run of the same drive into the world of the first one, by their first common
/// frame. Throws InputError, naming both, if they have none.
SE3 worldOfOther(const RunFolder& run, const RunFolder& other);

/// The command line of `motorcade view`.
struct ViewOptions {
  std::filesystem::path run;
  std::filesystem::path against;   // another run of the same drive; empty for none
  std::filesystem::path sequence;  // empty for the run's own
  std::optional<double> fps_hz;    // where the sequence has no times
  std::string address;             // ADDR:PORT
};

/// Shows a run that is over until SIGINT or SIGTERM. Returns the exit code.
int runView(const ViewOptions& options);

}  // namespace motorcade
