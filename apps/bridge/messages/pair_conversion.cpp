#include "apps/bridge/messages/pair_conversion.hpp"

#include <algorithm>

#include "io/images/sample_bits.hpp"
#include "io/layouts/given_cameras.hpp"
#include "io/rig/rectification.hpp"

namespace motorcade {
namespace {

ImageHeader headerOf(const ReceivedImage& image, const std::string& name) {
  return std::visit([&](const auto& message) { return imageHeaderOf(message, name); }, image.message);
}

int brightestOf(const ReceivedImage& image, const std::string& name) {
  return std::visit([&](const auto& message) { return brightestSampleOf(message, name); }, image.message);
}

/// Mosaics are resolved before the images are rectified: most messages name their own pattern.
Sequence withoutMosaic(Sequence cameras) {
  cameras.bayer.reset();
  return cameras;
}

StereoCamera cameraByInfos(Sequence& sequence, const CameraKnowledge& known, ImageSize size) {
  const auto& [left, right] = known.topics;
  const Rig rig =
      rigOf({.left = *known.infos[0], .right = *known.infos[1], .left_name = left.info, .right_name = right.info},
            isRectifiedTopic(left.image));
  const Rectification rectification = rectificationOf(rig, size);
  if (!rig.rectified) sequence.rectification = std::make_shared<const Rectification>(rectification);
  return rectification.camera;
}

}  // namespace

ImageSize sizeOf(const ReceivedImage& image, const std::string& name) { return headerOf(image, name).size; }

Sequence camerasOf(const CameraKnowledge& known, ImageSize size) {
  Sequence sequence{.folder = known.topics[0].image};
  sequence.given = absolute(known.given);
  sequence.camera =
      known.given.empty() ? cameraByInfos(sequence, known, size) : givenCamera(sequence, sequence.given, size);
  sequence.camera.width_px = size.width;
  sequence.camera.height_px = size.height;
  sequence.bayer = mosaicOf(sequence, known.given);
  return sequence;
}

PairConversion::PairConversion(const Sequence& cameras, const std::array<CameraTopics, 2>& topics)
    : topics_(topics),
      size_{cameras.camera.width_px, cameras.camera.height_px},
      bayer_(cameras.bayer),
      rectify_(withoutMosaic(cameras)) {}

/// The bits that hold the brightest sample of the pair.
int PairConversion::bitsFor(const ReceivedPair& pair) const {
  if (sample_bits_) return *sample_bits_;
  return usedSampleBits(0,
                        std::max(brightestOf(pair.left, topics_[0].image), brightestOf(pair.right, topics_[1].image)));
}

Image PairConversion::grayOf(const ReceivedImage& image, StereoSide side, int sample_bits) {
  const MessageConversion conversion{.size = size_, .sample_bits = sample_bits, .bayer = bayer_};
  const std::string& name = topics_[indexOf(side)].image;
  const auto gray = [&](const auto& message) { return grayImageOf(message, name, pool_, conversion); };
  return rectify_.prepared(std::visit(gray, image.message), side);
}

PairConversion::Grays PairConversion::operator()(const ReceivedPair& pair) {
  const int bits = bitsFor(pair);
  Grays grays{.left = grayOf(pair.left, StereoSide::kLeft, bits),
              .right = grayOf(pair.right, StereoSide::kRight, bits)};
  if (bits > 8) sample_bits_ = bits;
  return grays;
}

}  // namespace motorcade
