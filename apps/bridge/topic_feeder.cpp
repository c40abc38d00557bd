#include "apps/bridge/topic_feeder.hpp"

#include <utility>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "io/files/errors.hpp"
#include "io/images/sample_bits.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;

constexpr auto kNap = 50ms;                  // without an image; so often the state is looked at
constexpr auto kPatienceForInfos = 5s;       // then the log tells what is missing
constexpr auto kBetweenComplaints = 10s;     // about pairs that cannot be read
constexpr int kMostAtOnce = 64;              // images, then the state is looked at
constexpr std::size_t kMostEarlyPairs = 64;  // that wait for the cameras where none may be lost

Pair::Image viewOf(const Image& image) {
  return {
      .pixels = image.data(), .width_px = image.width(), .height_px = image.height(), .stride_bytes = image.stride()};
}

}  // namespace

TopicFeeder::TopicFeeder(ImageSubscriber& images, const Params& params)
    : images_(images),
      params_(params),
      pairing_({.tolerance_ns = params.tolerance_ns}),
      watch_({.topics = {params.cameras.topics[0].image, params.cameras.topics[1].image},
              .tolerance_ns = params.tolerance_ns},
             start_) {}

void TopicFeeder::takeInfos() {
  for (const StereoSide side : kStereoSides) {
    auto info = images_.takeInfo(side);
    auto& known = params_.cameras.infos[indexOf(side)];
    if (info && !known) known = std::move(info);  // a camera does not change while it is followed
  }
}

void TopicFeeder::takeMotions(Tracker& tracker) {
  while (const auto motion = images_.takeMotion()) {
    const auto pushed = tracker.push_motion(*motion);
    if (pushed.status != Tracker::Push::Status::kRejected || std::exchange(told_motion_, true)) continue;
    logWarning(fmt::format("a message of the vehicle's motion is of no use: {}", pushed.why));
  }
}

bool TopicFeeder::takeImage() {
  const StereoSide first = pairing_.waiting(StereoSide::kLeft) <= pairing_.waiting(StereoSide::kRight)
                               ? StereoSide::kLeft
                               : StereoSide::kRight;
  for (const StereoSide side : {first, otherThan(first)}) {
    auto image = images_.takeImage(side);
    if (!image) continue;
    watch_.imageCame(side, Clock::now());
    if (auto pair = pairing_.add(side, *std::move(image))) keep(*std::move(pair));
    return true;
  }
  return false;
}

bool TopicFeeder::takeImages() {
  int taken = 0;
  while (taken < kMostAtOnce && (pairs_.empty() || !params_.every_pair) && takeImage()) ++taken;
  return taken > 0 || !pairs_.empty();
}

void TopicFeeder::keep(ReceivedPair pair) {
  watch_.pairCame(Clock::now());
  pairs_.push_back(std::move(pair));
  if (pairs_.size() <= (params_.every_pair ? kMostEarlyPairs : 1)) return;
  pairs_.pop_front();
  ++counts_.overtaken;
}

void TopicFeeder::tell(const InputWatch::News& news) const {
  if (!news.bad) return logInfo(news.text);
  if (!news.side || images_.publishers(*news.side) > 0) return logWarning(news.text);
  const std::string& topic = params_.cameras.topics[indexOf(*news.side)].image;
  logWarning(fmt::format("{}: nobody publishes {} there", news.text, imageTypeOf(topic)));
}

void TopicFeeder::tellState() {
  for (const auto& news : watch_.look(Clock::now())) tell(news);
  counts_.unpaired = {pairing_.unpaired(StereoSide::kLeft), pairing_.unpaired(StereoSide::kRight)};
  const std::lock_guard lock(mutex_);
  told_counts_ = counts_;
  told_problem_ = watch_.problem();
}

void TopicFeeder::tellMissingInfos(Clock::time_point now) {
  if (told_infos_ || params_.cameras.complete() || now - start_ < kPatienceForInfos) return;
  told_infos_ = true;
  std::string missing;
  for (const StereoSide side : kStereoSides)
    if (!params_.cameras.infos[indexOf(side)])
      missing += (missing.empty() ? "" : " and ") + params_.cameras.topics[indexOf(side)].info;
  logWarning(fmt::format(
      "waiting for {} (sensor_msgs/CameraInfo); where nobody sends it, give --camera or --calibration", missing));
}

/// Reads the cameras. A pair whose size cannot be determined is left out.
void TopicFeeder::knowCameras() {
  while (!cameras_ && !pairs_.empty()) {
    std::optional<ImageSize> size;
    try {
      size = sizeOf(pairs_.front().left, params_.cameras.topics[0].image);
    } catch (const InputError& error) {
      refuse(error.what());
      pairs_.pop_front();
      continue;
    }
    cameras_ = camerasOf(params_.cameras, *size);
  }
}

bool TopicFeeder::awaitCameras(std::chrono::milliseconds patience) {
  for (const auto deadline = Clock::now() + patience; !cameras_ && Clock::now() < deadline;) {
    images_.wait(kNap);
    takeInfos();
    for (int taken = 0; taken < kMostAtOnce && takeImage();) ++taken;
    if (params_.cameras.complete()) knowCameras();
    tellState();
    tellMissingInfos(Clock::now());
  }
  return cameras_.has_value();
}

void TopicFeeder::refuse(const std::string& why) {
  ++counts_.unreadable;
  if (Clock::now() < next_complaint_) return;
  next_complaint_ = Clock::now() + kBetweenComplaints;
  logWarning(why);
}

void TopicFeeder::push(Tracker& tracker, PairConversion& conversion, const ReceivedPair& pair) {
  const bool knew_bits = conversion.sampleBits().has_value();
  PairConversion::Grays grays;
  try {
    grays = conversion(pair);
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  if (!knew_bits && conversion.sampleBits())
    logInfo(fmt::format("16-bit images, taken as {} bits by the brightest sample of the first pair",
                        *conversion.sampleBits()));
  ++counts_.pairs;
  const auto pushed =
      tracker.push({.left = viewOf(grays.left), .right = viewOf(grays.right), .stamp_ns = pair.left.stamp_ns});
  if (pushed.status == Tracker::Push::Status::kRejected) ++counts_.rejected;
}

void TopicFeeder::feed(Tracker& tracker, const std::stop_token& stop) {
  PairConversion conversion(*cameras_, params_.cameras.topics);
  while (!stop.stop_requested() && !hasAll()) {
    if (!takeImages()) images_.wait(kNap);
    takeInfos();
    takeMotions(tracker);
    for (; !pairs_.empty() && !hasAll() && !stop.stop_requested(); pairs_.pop_front())
      push(tracker, conversion, pairs_.front());
    tellState();
  }
  tracker.close();
}

InputCounts TopicFeeder::counts() const {
  const std::lock_guard lock(mutex_);
  return told_counts_;
}

std::string TopicFeeder::problem() const {
  const std::lock_guard lock(mutex_);
  return told_problem_;
}

}  // namespace motorcade
