#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <dds/dds.h>

#include "apps/bridge/dds/dds_configuration.hpp"
#include "tests/apps/bridge/bridge_json.hpp"

/// Subscribes to the topics of `motorcade bridge` on loopback as a node of ROS 2 would, and writes each message as a
/// line of JSON: bridge_subscriber DOMAIN SECONDS. It ends when all publishers that came have gone, or after so long.
namespace {

using motorcade::test::json;
using Clock = std::chrono::steady_clock;

constexpr int kMostTaken = 64;

/// Reader of a topic: reliable as ROS' are, but it keeps all, so that what is missing was not sent.
struct Reader {
  std::string topic;
  dds_entity_t reader;
  std::function<json(const void*)> convert;

  void take() const {
    std::vector<void*> samples(kMostTaken, nullptr);
    std::vector<dds_sample_info_t> infos(kMostTaken);
    const int taken = dds_take(reader, samples.data(), infos.data(), kMostTaken, kMostTaken);
    for (int i = 0; i < taken; ++i) {
      if (!infos[i].valid_data) continue;
      json line = convert(samples[i]);
      line["topic"] = topic;
      std::puts(line.dump().c_str());
    }
    if (taken > 0) dds_return_loan(reader, samples.data(), taken);
  }
  std::pair<std::uint32_t, std::uint32_t> publishersEverAndNow() const {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader, &status);
    return {status.total_count, status.current_count};
  }
};

template <class Message>
Reader subscribe(dds_entity_t participant, const dds_topic_descriptor_t& type, const std::string& topic) {
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t entity = dds_create_topic(participant, &type, topic.c_str(), nullptr, nullptr);
  const dds_entity_t reader = dds_create_reader(participant, entity, qos, nullptr);
  dds_delete_qos(qos);
  if (reader < 0) std::exit(4);
  return {topic, reader,
          [](const void* message) { return motorcade::test::jsonOf(*static_cast<const Message*>(message)); }};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // tests count the lines meanwhile
  const int domain = std::atoi(argv[1]);
  const auto deadline = Clock::now() + std::chrono::seconds(std::atoi(argv[2]));
  const auto id = static_cast<dds_domainid_t>(domain);
  if (dds_create_domain(id, motorcade::ddsConfiguration({.domain = domain}).c_str()) < 0) return 3;
  const dds_entity_t participant = dds_create_participant(id, nullptr, nullptr);
  if (participant < 0) return 3;
  const std::vector<Reader> readers{
      subscribe<geometry_msgs_msg_dds__PoseStamped_>(participant, geometry_msgs_msg_dds__PoseStamped__desc,
                                                     "rt/motorcade/pose"),
      subscribe<nav_msgs_msg_dds__Odometry_>(participant, nav_msgs_msg_dds__Odometry__desc, "rt/motorcade/odometry"),
      subscribe<visualization_msgs_msg_dds__MarkerArray_>(participant, visualization_msgs_msg_dds__MarkerArray__desc,
                                                          "rt/motorcade/objects"),
      subscribe<autoware_perception_msgs_msg_dds__TrackedObjects_>(
          participant, autoware_perception_msgs_msg_dds__TrackedObjects__desc, "rt/motorcade/tracked_objects"),
      subscribe<vision_msgs_msg_dds__Detection3DArray_>(participant, vision_msgs_msg_dds__Detection3DArray__desc,
                                                        "rt/motorcade/detections"),
      subscribe<diagnostic_msgs_msg_dds__DiagnosticArray_>(participant, diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                                                           "rt/diagnostics"),
      subscribe<tf2_msgs_msg_dds__TFMessage_>(participant, tf2_msgs_msg_dds__TFMessage__desc, "rt/tf")};
  for (bool gone = false; !gone && Clock::now() < deadline;) {
    std::uint32_t ever = 0, now = 0;
    for (const Reader& reader : readers) {
      const auto [ever_here, now_here] = reader.publishersEverAndNow();
      ever += ever_here;
      now += now_here;
    }
    gone = ever > 0 && now == 0;
    for (const Reader& reader : readers) reader.take();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  dds_delete(participant);
  return 0;
}
