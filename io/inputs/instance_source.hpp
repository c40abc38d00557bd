#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/instance_labels.hpp"
#include "core/object_pool.hpp"
#include "io/inputs/pair_source.hpp"

namespace motorcade {

/// Throws InputError where the folder holds no instance labels, or where the first file, by name, cannot be read or has
/// another size. The message names the folder or the file.
void requireInstances(const std::filesystem::path& folder, int width_px, int height_px);

/// The pairs of another source, each with the instance labels of its frame from a folder. Another program's
/// segmentation wrote them: NNNNNN.png, gray of 8 or 16 bits or with a palette. Frames without a file have none.
class InstanceSource final : public ForwardingSource {
 public:
  /// Labels have the size of the rectified images.
  InstanceSource(std::unique_ptr<PairSource> pairs, std::filesystem::path folder, int width_px, int height_px);

  /// Labels that cannot be read are left out, and reported at the end.
  std::optional<StereoFrame> next() override;
  SourceEnd finish() override;

 private:
  std::shared_ptr<const InstanceLabels> labelsOf(FrameId frame);

  std::filesystem::path folder_;
  int width_px_, height_px_;
  ObjectPool<InstanceLabels> labels_;
  int read_ = 0, unreadable_ = 0;
  std::string first_problem_;
};

}  // namespace motorcade
