#include "apps/bridge/dds/image_subscriber.hpp"

#include <utility>

#include "apps/bridge/dds/dds_entity.hpp"
#include "apps/bridge/dds/dds_values.hpp"

namespace motorcade {
namespace {

using RawImage = sensor_msgs_msg_dds__Image_;
using CompressedImage = sensor_msgs_msg_dds__CompressedImage_;
using Info = sensor_msgs_msg_dds__CameraInfo_;
using Twist = geometry_msgs_msg_dds__TwistWithCovarianceStamped_;

constexpr int kNewestImages = 4;  // kept until they are taken
constexpr int kNewestTwists = 256;
constexpr int kMostImages = 32;  // that wait, where none may be lost
constexpr const char* kCompressed = "/compressed";

bool isCompressed(const std::string& topic) { return topic.ends_with(kCompressed); }

DdsQos lastKept(int count) {
  DdsQos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, count);
  return qos;
}

DdsQos everyKept(int count) {
  DdsQos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_resource_limits(qos.get(), count, DDS_LENGTH_UNLIMITED, count);
  return qos;
}

/// One topic with its reader.
class Reader {
 public:
  Reader(dds_entity_t participant, const dds_topic_descriptor_t& type, const std::string& topic, const DdsQos& qos)
      : type_(type),
        topic_(dds_create_topic(participant, &type, ("rt" + topic).c_str(), nullptr, nullptr), "topic " + topic),
        reader_(dds_create_reader(participant, topic_.get(), qos.get(), nullptr), "topic " + topic),
        waiting_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "topic " + topic) {}

  dds_entity_t condition() const { return waiting_.get(); }

  /// The oldest waiting sample, freed with its last owner.
  template <class Sample>
  std::shared_ptr<const Sample> take() const {
    const auto free = [&type = type_](Sample* sample) {
      dds_sample_free(sample, &type, DDS_FREE_CONTENTS);
      delete sample;
    };
    const std::shared_ptr<Sample> sample(new Sample{}, free);
    void* place = sample.get();
    dds_sample_info_t info{};
    while (dds_take(reader_.get(), &place, &info, 1, 1) > 0)
      if (info.valid_data) return sample;
    return nullptr;
  }
  int publishers() const {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader_.get(), &status);
    return static_cast<int>(status.current_count);
  }

 private:
  const dds_topic_descriptor_t& type_;
  DdsEntity topic_, reader_, waiting_;
};

template <class Sample>
std::optional<ReceivedImage> receivedFrom(const Reader& reader) {
  auto sample = reader.take<Sample>();
  if (!sample) return std::nullopt;
  const auto message = imageMessageOf(*sample);
  return ReceivedImage{.stamp_ns = message.stamp_ns, .message = message, .holder = std::move(sample)};
}

/// The readers of one camera's topics.
struct CameraReaders {
  CameraReaders(dds_entity_t participant, const CameraTopics& topics, const DdsQos& qos)
      : compressed(isCompressed(topics.image)),
        images(participant, compressed ? sensor_msgs_msg_dds__CompressedImage__desc : sensor_msgs_msg_dds__Image__desc,
               topics.image, qos) {
    if (!topics.info.empty())
      infos.emplace(participant, sensor_msgs_msg_dds__CameraInfo__desc, topics.info, lastKept(1));
  }
  void attachTo(dds_entity_t waitset) const {
    dds_waitset_attach(waitset, images.condition(), 0);
    if (infos) dds_waitset_attach(waitset, infos->condition(), 0);
  }

  bool compressed;
  Reader images;
  std::optional<Reader> infos{};
};

}  // namespace

struct ImageSubscriber::Impl {
  Impl(const DdsPlace& place, const Params& params, const DdsQos& qos)
      : participant(dds_create_participant(static_cast<dds_domainid_t>(place.domain), nullptr, nullptr), textOf(place)),
        left(participant.get(), params.topics[0], qos),
        right(participant.get(), params.topics[1], qos),
        anything(dds_create_waitset(participant.get()), textOf(place)) {
    left.attachTo(anything.get());
    right.attachTo(anything.get());
    if (!params.vehicle_motion.empty())
      motions.emplace(participant.get(), geometry_msgs_msg_dds__TwistWithCovarianceStamped__desc, params.vehicle_motion,
                      lastKept(kNewestTwists));
  }
  const CameraReaders& of(StereoSide side) const { return side == StereoSide::kLeft ? left : right; }

  DdsEntity participant;
  CameraReaders left, right;
  std::optional<Reader> motions{};
  DdsEntity anything;
};

ImageSubscriber::ImageSubscriber(const DdsPlace& place, const Params& params)
    : impl_(std::make_unique<Impl>(place, params,
                                   params.every_image ? everyKept(kMostImages) : lastKept(kNewestImages))) {}
ImageSubscriber::~ImageSubscriber() = default;

void ImageSubscriber::wait(std::chrono::milliseconds patience) const {
  dds_waitset_wait(impl_->anything.get(), nullptr, 0, DDS_MSECS(patience.count()));
}

std::optional<ReceivedImage> ImageSubscriber::takeImage(StereoSide side) {
  const CameraReaders& camera = impl_->of(side);
  return camera.compressed ? receivedFrom<CompressedImage>(camera.images) : receivedFrom<RawImage>(camera.images);
}

std::optional<CameraInfoMessage> ImageSubscriber::takeInfo(StereoSide side) {
  const CameraReaders& camera = impl_->of(side);
  if (!camera.infos) return std::nullopt;
  const auto sample = camera.infos->take<Info>();
  if (!sample) return std::nullopt;
  return cameraInfoMessageOf(*sample);
}

std::optional<VehicleMotion> ImageSubscriber::takeMotion() {
  if (!impl_->motions) return std::nullopt;
  const auto sample = impl_->motions->take<Twist>();
  if (!sample) return std::nullopt;
  return vehicleMotionOf(*sample);
}

int ImageSubscriber::publishers(StereoSide side) const { return impl_->of(side).images.publishers(); }

std::string imageTypeOf(const std::string& topic) {
  return isCompressed(topic) ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image";
}

}  // namespace motorcade
