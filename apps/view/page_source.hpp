#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "apps/view/page_json.hpp"
#include "apps/view/run_counts.hpp"

namespace motorcade {

/// Interface through which the server reads a run, from several threads at once.
class PageSource {
 public:
  virtual ~PageSource() = default;
  virtual ShownRun run() const = 0;
  virtual RunSnapshot snapshot() const = 0;
  /// `{"frames":[...]}` from a frame of the sequence on, at most `count` of those that are still known. Data that only
  /// the image shows is left out.
  virtual std::string framesJson(std::int64_t from, std::size_t count) const = 0;
  /// One frame with all its data; empty where the frame is not known any more.
  virtual std::string frameJson(std::int64_t frame) const = 0;
  /// The run as a whole (docs/view.md); empty where it is not over.
  virtual std::string overviewJson() const { return ""; }
  /// Another run of the same drive to compare with, in the same world; null for none.
  virtual const PageSource* against() const { return nullptr; }
  /// The left image as JPEG; null where it cannot be had.
  virtual std::shared_ptr<const std::string> picture(std::int64_t frame) = 0;
  /// `pause`, `resume` or `step`; false where the run cannot be held.
  virtual bool control(const std::string& action) = 0;
};

}  // namespace motorcade
