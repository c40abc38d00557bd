#include "apps/export/osi_trace.hpp"

#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <osi3/osi_sensordata.pb.h>

#include "apps/console/progress.hpp"
#include "apps/export/exported_frame.hpp"
#include "apps/export/foxglove_fields.hpp"
#include "apps/export/mcap_writer.hpp"
#include "apps/export/osi_sensor_data.hpp"
#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {
namespace {

constexpr const char* kTopic = "Motorcade.SensorData";
constexpr const char* kDescription = "camera and moving objects that Motorcade estimated from stereo images";

std::string osiVersion() { return fmt::format("{}.{}.{}", kOsiVersion.major, kOsiVersion.minor, kOsiVersion.patch); }

std::string protobufVersion() {
  constexpr int kMajor = GOOGLE_PROTOBUF_VERSION / 1'000'000, kMinor = GOOGLE_PROTOBUF_VERSION / 1000 % 1000;
  return fmt::format("{}.{}.{}", kMajor, kMinor, GOOGLE_PROTOBUF_VERSION % 1000);
}

mcap::Texts traceFacts(const std::string& run) {
  return {{"version", kOsiTraceVersion},
          {"min_osi_version", osiVersion()},
          {"max_osi_version", osiVersion()},
          {"min_protobuf_version", protobufVersion()},
          {"max_protobuf_version", protobufVersion()},
          {"description", fmt::format("{}: {}", run, kDescription)},
          {"data_sources", "motorcade"}};
}

mcap::ChannelId addSensorData(mcap::Writer& writer) {
  const google::protobuf::Descriptor& type = *osi3::SensorData::descriptor();
  return writer.addChannel(writer.addSchema(type.full_name(), descriptorsOf(type)), kTopic,
                           {{"net.asam.osi.trace.channel.osi_version", osiVersion()},
                            {"net.asam.osi.trace.channel.protobuf_version", protobufVersion()},
                            {"net.asam.osi.trace.channel.description", kDescription}});
}

std::vector<TimedPose> wayOf(const RecordedDrive& drive, const RunFolder& run) {
  std::vector<TimedPose> way;
  for (std::size_t i = 0; i < drive.T_world_cam.size(); ++i)
    way.push_back({exportedFrame(drive, run, i).estimate.head, sensorPose(drive.T_world_cam[i])});
  return way;
}

/// Covariances of the estimates that are written: the final ones, or the online ones of a run that was killed.
std::map<FrameId, Matrix6d> poseCovariances(const RunFolder& run) {
  std::map<FrameId, Matrix6d> covariances;
  const auto& shown = fullerTrajectories(run).pose_covariances;
  for (const auto& row : shown.empty() ? run.online.pose_covariances : shown) covariances[row.frame] = row.covariance;
  return covariances;
}

}  // namespace

OsiTrace exportOsi(const RunFolder& run, const std::filesystem::path& file,
                   const std::optional<SE3>& T_vehicle_sensor) {
  const RecordedDrive drive = recordedDrive(run);
  const std::vector<TimedPose> way = wayOf(drive, run);
  const auto covariances = poseCovariances(run);
  mcap::Writer writer(file);
  writer.writeMetadata("net.asam.osi.trace", traceFacts(drive.name));
  const mcap::ChannelId channel = addSensorData(writer);
  OsiTrace trace;
  Progress progress("frame", way.size());
  for (std::size_t i = 0; i < way.size(); ++i) {
    SensedFrame frame{.estimate = exportedFrame(drive, run, i).estimate, .motion = sensorMotionAt(way, i)};
    const auto covariance = covariances.find(frame.estimate.head.frame);
    if (covariance != covariances.end()) frame.estimate.camera_covariances.pose = covariance->second;
    writer.write(channel, frame.estimate.head.stamp, sensorData(frame, T_vehicle_sensor).SerializeAsString());
    trace.objects += frame.estimate.objects.size();
    progress.show(++trace.frames);
  }
  writer.close();
  trace.bytes = writer.bytes();
  return trace;
}

}  // namespace motorcade
