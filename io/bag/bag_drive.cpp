#include "io/bag/bag_drive.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/bag/bag_pairs.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/layouts/given_cameras.hpp"
#include "io/messages/camera_info_message.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// The first pairs, and the facts about the whole drive that they tell.
struct FirstPairs {
  std::vector<std::int64_t> stamps_ns{};
  ImageHeader header{};
  std::string name{};  // of the first image, for messages
  int brightest = 0;   // sample, where they have 16 bits

  void add(const BagPair& pair) {
    constexpr std::size_t kLookedAt = 5;
    if (stamps_ns.empty()) {
      header = pair.left.header();
      name = pair.left.name();
      if (const ImageHeader right = pair.right.header(); right.size != header.size)
        throw InputError(pair.right.name() + ": has " + right.size.text() + " pixels, the left image has " +
                         header.size.text());
    }
    if (stamps_ns.size() < kLookedAt)
      brightest = std::max({brightest, pair.left.brightestSample(), pair.right.brightestSample()});
    stamps_ns.push_back(pair.left.stamp_ns);
  }
};

[[noreturn]] void failWithoutPair(BagPairs& pairs, const std::string& bag, const ImageTopics& topics) {
  const std::size_t left = pairs.images(StereoSide::kLeft), right = pairs.images(StereoSide::kRight);
  if (left == 0 || right == 0)
    failWithTopics(pairs.bag(), bag + ": has no message of " + printable(left == 0 ? topics.left : topics.right, 200));
  std::string text = bag + ": has no pair: of " + std::to_string(left) + " left and " + std::to_string(right) +
                     " right images, no two have stamps within " + std::to_string(BagPairs::kTolerance_ns / 1'000'000) +
                     " ms";
  if (const auto nearest_ns = pairs.nearest_ns())
    text += " (the nearest are " + std::to_string(*nearest_ns / 1'000'000) + " ms apart)";
  throw InputError(text +
                   ". A file with one topic behind the other is put in order by\n  mcap sort BAG.mcap -o SORTED.mcap");
}

/// Reads until the pairs tell the rate, and on to the camera_info where that comes later.
FirstPairs readFirstPairs(BagPairs& pairs, bool infos_needed) {
  constexpr std::size_t kPairs = 16, kPairsWithoutInfo = 300;
  FirstPairs first;
  const auto knowsInfos = [&] { return pairs.info(StereoSide::kLeft) && pairs.info(StereoSide::kRight); };
  try {
    while (first.stamps_ns.size() < (infos_needed && !knowsInfos() ? kPairsWithoutInfo : kPairs)) {
      const auto pair = pairs.next();
      if (!pair) break;
      first.add(*pair);
    }
  } catch (const InputError&) {  // the pairs before the damage are good, and the source tells of it
    if (first.stamps_ns.empty()) throw;
  }
  return first;
}

std::optional<double> medianRate_hz(const std::vector<std::int64_t>& stamps_ns) {
  if (stamps_ns.size() < 2) return std::nullopt;
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i)
    periods_s.push_back(secondsBetween({stamps_ns[i - 1]}, {stamps_ns[i]}));
  const auto middle = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
  std::ranges::nth_element(periods_s, middle);
  return 1 / *middle;
}

CameraInfoPair requiredInfos(const BagPairs& pairs, const std::string& bag, const ImageTopics& topics) {
  CameraInfoPair infos{.left_name = bag + ": " + printable(cameraInfoTopicOf(topics.left), 200),
                       .right_name = bag + ": " + printable(cameraInfoTopicOf(topics.right), 200)};
  if (infos.left_name == infos.right_name)
    throw InputError(infos.left_name +
                     ": would be the camera_info of both images; give --camera fx,fy,cx,cy,baseline of a rectified "
                     "pair, or --calibration FILE");
  for (const StereoSide side : kStereoSides)
    if (!pairs.info(side))
      throw InputError(
          (side == StereoSide::kLeft ? infos.left_name : infos.right_name) +
          ": has no message of sensor_msgs/CameraInfo with the first pairs; record it beside the images, or "
          "give --camera fx,fy,cx,cy,baseline of a rectified pair, or --calibration FILE");
  infos.left = *pairs.info(StereoSide::kLeft), infos.right = *pairs.info(StereoSide::kRight);
  return infos;
}

StereoCamera cameraByInfos(Sequence& sequence, const CameraInfoPair& infos, const ImageTopics& topics, ImageSize size) {
  const Rig rig = rigOf(infos, isRectifiedTopic(topics.left));
  const Rectification rectification = rectificationOf(rig, size);
  if (!rig.rectified) sequence.rectification = std::make_shared<const Rectification>(rectification);
  sequence.calibrated_by = cameraInfoTopicOf(topics.left) + "," + cameraInfoTopicOf(topics.right);
  return rectification.camera;
}

SampleUse sampleUseOf(const FirstPairs& first) {
  const int bits = usedSampleBits(first.header.told_bits, first.brightest);
  const std::string brightest = "the brightest sample of the first pairs is " + std::to_string(first.brightest);
  if (bits == kAllSampleBits) return {bits, "their upper eight bits are used: " + brightest};
  return {bits, "taken as " + std::to_string(bits) + " bits: " + brightest};
}

Sequence sequenceOf(const fs::path& bag, const FirstPairs& first, const GivenCameras& given) {
  Sequence sequence{.folder = fs::absolute(bag).lexically_normal(), .layout = kBagLayout};
  sequence.stamps_measured = true;
  sequence.given = absolute(given);
  sequence.bayer = mosaicOf(sequence, given);
  if (sequence.bayer && first.header.channels != 1) throw InputError(first.name + kNoMosaic);
  if (first.header.bits == kAllSampleBits) sequence.samples = sampleUseOf(first);
  return sequence;
}

}  // namespace

BagDrive openBagDrive(const fs::path& bag, const std::string& topics, const GivenCameras& given) {
  if (topics.empty())
    failWithTopics(*openBag(bag), bag.string() + ": name the topics of both cameras' images by --topics LEFT,RIGHT");
  BagDrive drive{.topics = parseImageTopics(topics)};
  const bool by_infos = given.empty();
  BagPairs pairs(bag, drive.topics, by_infos ? BagPairs::Infos::kTake : BagPairs::Infos::kLeaveOut);
  const FirstPairs first = readFirstPairs(pairs, by_infos);
  if (first.stamps_ns.empty()) failWithoutPair(pairs, bag.string(), drive.topics);
  const ImageSize size = first.header.size;
  drive.sequence = sequenceOf(bag, first, given);
  Sequence& sequence = drive.sequence;
  sequence.camera = by_infos
                        ? cameraByInfos(sequence, requiredInfos(pairs, bag.string(), drive.topics), drive.topics, size)
                        : givenCamera(sequence, sequence.given, size);
  sequence.camera.width_px = size.width;
  sequence.camera.height_px = size.height;
  drive.conversion = {
      .size = size, .sample_bits = sequence.samples ? sequence.samples->bits : kAllSampleBits, .bayer = sequence.bayer};
  drive.rate_hz = medianRate_hz(first.stamps_ns).value_or(10);
  drive.first = {first.stamps_ns.front()};
  return drive;
}

}  // namespace motorcade
