#include <new>
#include <string>

#include "apps/interface/camera_model.hpp"
#include "io/files/errors.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

class Recording::Impl {
 public:
  explicit Impl(const std::string& folder) : sequence_(openSequence(folder)), reader_(sequence_) {}

  const Sequence& sequence() const { return sequence_; }
  Pair read(std::size_t index);

 private:
  Pair::Image view(Image& image, std::size_t index, StereoSide side);

  Sequence sequence_;
  PairReader reader_;
  Image left_, right_;  // of the pair that was read last
};

/// Views an image of a pair; it has no pixels when its file cannot be read.
Pair::Image Recording::Impl::view(Image& image, std::size_t index, StereoSide side) {
  image = Image();
  try {
    image = reader_.read(sequence_.frames[index], side);
  } catch (const UserError&) {
    return {};
  }
  return {
      .pixels = image.data(), .width_px = image.width(), .height_px = image.height(), .stride_bytes = image.stride()};
}

Pair Recording::Impl::read(std::size_t index) {
  Pair pair;
  pair.left = view(left_, index, StereoSide::kLeft);
  pair.right = view(right_, index, StereoSide::kRight);
  pair.stamp_ns = sequence_.stamps[index].ns;
  pair.frame = static_cast<std::int64_t>(index);
  return pair;
}

Recording::Recording(const std::string& folder) try : impl_(std::make_unique<Impl>(folder)) {
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  throw Error("folder", error.what());
}
Recording::~Recording() = default;

Camera Recording::camera() const { return cameraOf(impl_->sequence().camera, impl_->sequence().calibration.sigmas); }
std::int64_t Recording::size() const { return static_cast<std::int64_t>(impl_->sequence().frames.size()); }

Pair Recording::read(std::int64_t index) {
  if (index < 0 || index >= size())
    throw Error("index", "is " + std::to_string(index) + " of " + std::to_string(size()) + " pairs");
  return impl_->read(static_cast<std::size_t>(index));
}

}  // namespace motorcade
