#include "apps/bridge/dds/dds_publisher.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <thread>

#include <dds/dds.h>
#include <fmt/format.h>

#include "apps/bridge/dds/dds_entity.hpp"
#include "apps/bridge/dds/dds_messages.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;

constexpr int kHistory = 10;  // messages; ROS 2's default
constexpr dds_duration_t kMostBlocking = DDS_MSECS(10);
constexpr auto kLinger = 1s;  // at the end, of all writers together

DdsQos rosDefault() {
  DdsQos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kMostBlocking);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kHistory);
  const dds_data_representation_id_t as_ros = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &as_ros);
  return qos;
}

/// In the order of Topic.
const std::array kTypes{&geometry_msgs_msg_dds__PoseStamped__desc,
                        &nav_msgs_msg_dds__Odometry__desc,
                        &visualization_msgs_msg_dds__MarkerArray__desc,
                        &autoware_perception_msgs_msg_dds__TrackedObjects__desc,
                        &vision_msgs_msg_dds__Detection3DArray__desc,
                        &diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                        &tf2_msgs_msg_dds__TFMessage__desc};
static_assert(kTypes.size() == kTopicNames.size());

/// One topic with its writer.
class Writer {
 public:
  Writer(dds_entity_t participant, Topic topic)
      : Writer(participant, *kTypes.at(static_cast<std::size_t>(topic)),
               kTopicNames.at(static_cast<std::size_t>(topic)).ros) {}

  void write(const void* message) {
    const bool acknowledged = dds_wait_for_acks(writer_.get(), 0) == DDS_RETCODE_OK;
    unacknowledged_ = acknowledged ? 0 : unacknowledged_;
    const dds_return_t outcome = dds_write(writer_.get(), message);
    if (outcome == DDS_RETCODE_TIMEOUT) {
      ++counts_.timed_out;
    } else if (outcome != DDS_RETCODE_OK) {
      throw OutputError(fmt::format("topic {}: DDS says: {}", counts_.topic, dds_strretcode(outcome)));
    } else {
      ++counts_.published;
      if (++unacknowledged_ > kHistory) ++counts_.overtaken;
    }
  }
  /// Waits until every subscriber has acknowledged all messages.
  void settle(std::chrono::nanoseconds patience) const { dds_wait_for_acks(writer_.get(), patience.count()); }

  int subscribers() const {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_.get(), &status);
    return static_cast<int>(status.current_count);
  }
  DdsPublisher::Counts counts() const {
    DdsPublisher::Counts counts = counts_;
    counts.subscribers = subscribers();
    return counts;
  }

 private:
  /// ROS' topic /NAME is rt/NAME in DDS.
  Writer(dds_entity_t participant, const dds_topic_descriptor_t& type, const std::string& name)
      : qos_(rosDefault()),
        topic_(dds_create_topic(participant, &type, ("rt/" + name).c_str(), qos_.get(), nullptr), "topic " + name),
        writer_(dds_create_writer(participant, topic_.get(), qos_.get(), nullptr), "topic " + name) {
    counts_.topic = "/" + name;
  }

  DdsQos qos_;
  DdsEntity topic_, writer_;
  DdsPublisher::Counts counts_{};
  int unacknowledged_ = 0;  // since all were
};

}  // namespace

/// The members are created and ended in their order.
struct DdsPublisher::Impl {
  Impl(const DdsPlace& place, const std::set<Topic>& topics)
      : domain(dds_create_domain(static_cast<dds_domainid_t>(place.domain), ddsConfiguration(place).c_str()),
               textOf(place)),
        shielded(isLoopback(place) && bindSocketsToLoopback()),
        participant(dds_create_participant(static_cast<dds_domainid_t>(place.domain), nullptr, nullptr),
                    textOf(place)) {
    for (const Topic topic : topics) writers.try_emplace(topic, participant.get(), topic);
  }
  template <class Message>
  void write(Topic topic, const Message& message) {
    writers.at(topic).write(&message);
  }

  DdsEntity domain;
  bool shielded;
  DdsEntity participant;
  std::map<Topic, Writer> writers{};
};

DdsPublisher::DdsPublisher(const DdsPlace& place, const std::set<Topic>& topics)
    : impl_(std::make_unique<Impl>(place, topics)) {}

DdsPublisher::~DdsPublisher() {
  const auto deadline = std::chrono::steady_clock::now() + kLinger;
  for (const auto& [topic, writer] : impl_->writers)
    writer.settle(std::max<std::chrono::nanoseconds>(0ns, deadline - std::chrono::steady_clock::now()));
}

bool DdsPublisher::waitForSubscribers(int count, std::chrono::milliseconds patience,
                                      const std::stop_token& stop) const {
  constexpr auto kBetween = 10ms;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  const auto there = [&] {
    return std::ranges::all_of(impl_->writers, [&](const auto& each) { return each.second.subscribers() >= count; });
  };
  while (!there()) {
    if (stop.stop_requested() || std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kBetween);
  }
  return true;
}

bool DdsPublisher::publishes(Topic topic) const { return impl_->writers.contains(topic); }

void DdsPublisher::publish(const ros::PoseStamped& message) { impl_->write(Topic::kPose, ddsView(message)); }
void DdsPublisher::publish(const ros::Odometry& message) { impl_->write(Topic::kOdometry, ddsView(message)); }
void DdsPublisher::publish(const ros::MarkerArray& message) { impl_->write(Topic::kMarkers, ddsView(message).message); }
void DdsPublisher::publish(const ros::TrackedObjects& message) {
  impl_->write(Topic::kTrackedObjects, ddsView(message).message);
}
void DdsPublisher::publish(const ros::Detection3DArray& message) {
  impl_->write(Topic::kDetections, ddsView(message).message);
}
void DdsPublisher::publish(const ros::DiagnosticArray& message) {
  impl_->write(Topic::kDiagnostics, ddsView(message).message);
}
void DdsPublisher::publish(const ros::TransformStamped& message) { impl_->write(Topic::kTf, ddsView(message).message); }

std::vector<DdsPublisher::Counts> DdsPublisher::counts() const {
  std::vector<Counts> counts;
  for (const auto& [topic, writer] : impl_->writers) counts.push_back(writer.counts());
  return counts;
}

bool DdsPublisher::isShielded() const { return impl_->shielded; }

}  // namespace motorcade
