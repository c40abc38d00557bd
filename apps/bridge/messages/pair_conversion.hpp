#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "core/image.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"
#include "io/messages/stamp_pairing.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// An image as it came, and the owner of its bytes.
struct ReceivedImage {
  std::int64_t stamp_ns = 0;
  std::variant<ImageMessage, CompressedImageMessage> message{};
  std::shared_ptr<const void> holder{};
};

/// Names of a camera's topics, as ROS has them: `/left/image_raw`.
struct CameraTopics {
  std::string image{}, info{};  // no info: it is not read
};

using ReceivedPair = StampPairing<ReceivedImage>::Pair;

/// The image's size, from its header. Throws InputError, which begins with `name`.
ImageSize sizeOf(const ReceivedImage& image, const std::string& name);

/// Knowledge of the cameras: the user's, or else both sides' camera_info.
struct CameraKnowledge {
  std::array<CameraTopics, 2> topics{};
  GivenCameras given{};
  std::array<std::optional<CameraInfoMessage>, 2> infos{};

  bool complete() const { return !given.empty() || (infos[0] && infos[1]); }
};

/// The camera and its rectification. Throws InputError or UsageError.
Sequence camerasOf(const CameraKnowledge& known, ImageSize size);

/// Converts received images to those that the tracker takes: gray, of the camera's size, rectified. Remembers how many
/// bits the samples of 16 bits use, which is the same for all pairs.
class PairConversion {
 public:
  struct Grays {
    Image left{}, right{};
  };
  PairConversion(const Sequence& cameras, const std::array<CameraTopics, 2>& topics);

  /// Throws InputError naming the topic.
  Grays operator()(const ReceivedPair& pair);
  /// The bits that samples of 16 bits use, once they are known.
  std::optional<int> sampleBits() const { return sample_bits_; }

 private:
  int bitsFor(const ReceivedPair& pair) const;
  Image grayOf(const ReceivedImage& image, StereoSide side, int sample_bits);

  std::array<CameraTopics, 2> topics_;
  ImageSize size_;
  std::optional<BayerPattern> bayer_;
  std::optional<int> sample_bits_{};
  PairReader rectify_;
  ImagePool pool_;
};

}  // namespace motorcade
