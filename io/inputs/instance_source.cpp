#include "io/inputs/instance_source.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Throws InputError where there is none.
fs::path firstByName(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw InputError(folder.string() + ": is no folder; instance labels are a folder of PNG files, one for a frame");
  fs::path first;
  for (const auto& entry : fs::directory_iterator(folder))
    if (isInstanceFile(entry.path()) && (first.empty() || entry.path() < first)) first = entry.path();
  if (first.empty())
    throw InputError(folder.string() + ": holds no instance labels; they are called NNNNNN.png, by the frame's number");
  return first;
}

/// Throws InputError naming the file.
Gray16Image readLabels(const fs::path& file, int width_px, int height_px) {
  Gray16Image image = readInstances(file);
  if (image.width != width_px || image.height != height_px)
    throw InputError(file.string() + ": has " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " pixels, the rectified images have " + std::to_string(width_px) + " x " +
                     std::to_string(height_px));
  return image;
}

std::string countOfFiles(int files) {
  return files == 1 ? "a file of instance labels is" : std::to_string(files) + " files of instance labels are";
}

}  // namespace

void requireInstances(const fs::path& folder, int width_px, int height_px) {
  readLabels(firstByName(folder), width_px, height_px);
}

InstanceSource::InstanceSource(std::unique_ptr<PairSource> pairs, fs::path folder, int width_px, int height_px)
    : ForwardingSource(std::move(pairs)), folder_(std::move(folder)), width_px_(width_px), height_px_(height_px) {}

std::optional<StereoFrame> InstanceSource::next() {
  auto frame = ForwardingSource::next();
  if (frame && !frame->rejected()) frame->inputs.instances = labelsOf(frame->head.frame);
  return frame;
}

std::shared_ptr<const InstanceLabels> InstanceSource::labelsOf(FrameId frame) try {
  const fs::path file = instanceFile(folder_, frame);
  if (!fs::exists(file)) return nullptr;
  const Gray16Image image = readLabels(file, width_px_, height_px_);
  auto labels = labels_.acquire();
  labels->resize(image.width, image.height);
  std::ranges::copy(image.pixels, labels->mutableRow(0));
  ++read_;
  return labels;
} catch (const std::exception& error) {
  if (++unreadable_ == 1) first_problem_ = error.what();
  return nullptr;
}

SourceEnd InstanceSource::finish() {
  SourceEnd end = ForwardingSource::finish();
  if (unreadable_ > 0)
    end.instances = countOfFiles(unreadable_) + " left out: " + first_problem_;
  else if (read_ == 0)
    end.instances = folder_.string() + ": holds no instance labels of any frame that was taken";
  return end;
}

}  // namespace motorcade
