#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "apps/recorded/recorded_drive.hpp"
#include "apps/view/page_source.hpp"
#include "apps/view/sequence_pictures.hpp"

namespace motorcade {

/// A run that is over, for the page.
class RecordedView : public PageSource {
 public:
  /// Throws InputError naming the file that cannot be read.
  RecordedView(const RunFolder& run, const Sequence& sequence);

  ShownRun run() const override { return run_; }
  RunSnapshot snapshot() const override;
  std::string framesJson(std::int64_t from, std::size_t count) const override;
  std::string frameJson(std::int64_t frame) const override;
  std::shared_ptr<const std::string> picture(std::int64_t frame) override { return pictures_.jpeg(frame); }
  bool control(const std::string& /*action*/) override { return false; }

 private:
  bool has(std::int64_t frame) const { return frame >= run_.first_frame && frame < run_.end_frame; }
  ShownFrame shown(std::int64_t frame, FrameDetail detail) const;

  ShownRun run_;
  RecordedDrive drive_;
  std::map<std::int64_t, FrameRow> rows_;
  std::map<std::int64_t, ShownTiming> timings_;
  std::map<std::int64_t, std::vector<std::string>> outlines_;  // lines of outlines.jsonl
  std::map<std::int64_t, RoadPlane> roads_;
  RunCounts counts_;
  SequencePictures pictures_;
};

}  // namespace motorcade
