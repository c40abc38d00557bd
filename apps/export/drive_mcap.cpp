#include "apps/export/drive_mcap.hpp"

#include <foxglove/CameraCalibration.pb.h>
#include <foxglove/CompressedImage.pb.h>
#include <foxglove/FrameTransforms.pb.h>
#include <foxglove/PointCloud.pb.h>
#include <foxglove/PoseInFrame.pb.h>
#include <foxglove/PosesInFrame.pb.h>
#include <foxglove/SceneUpdate.pb.h>
#include <motorcade/FrameDiagnostics.pb.h>

#include "apps/export/foxglove_fields.hpp"

namespace motorcade {
namespace {

/// Most poses of the path in a message. Of a longer path every second pose stays, then every fourth, and so on.
constexpr std::size_t kMostPoses = 500;

/// Each topic has a message type of its own.
template <class Message>
mcap::ChannelId addTopic(mcap::Writer& writer, const char* topic) {
  const google::protobuf::Descriptor& type = *Message::descriptor();
  return writer.addChannel(writer.addSchema(type.full_name(), descriptorsOf(type)), topic);
}

}  // namespace

DriveMcap::DriveMcap(const std::filesystem::path& file, const StereoCamera& camera)
    : writer_(file),
      camera_(camera),
      image_(addTopic<foxglove::CompressedImage>(writer_, "/camera/left/compressed")),
      calibration_(addTopic<foxglove::CameraCalibration>(writer_, "/camera/calibration")),
      transforms_(addTopic<foxglove::FrameTransforms>(writer_, "/tf")),
      pose_(addTopic<foxglove::PoseInFrame>(writer_, "/camera/pose")),
      path_(addTopic<foxglove::PosesInFrame>(writer_, "/camera/path")),
      objects_(addTopic<foxglove::SceneUpdate>(writer_, "/objects")),
      points_(addTopic<foxglove::PointCloud>(writer_, "/points")),
      diagnostics_(addTopic<FrameDiagnostics>(writer_, "/diagnostics")) {}

void DriveMcap::write(const ExportedFrame& frame) {
  const FrameEstimate& estimate = frame.estimate;
  writer_.write(transforms_, estimate.head.stamp, transformsMessage(estimate));
  writer_.write(calibration_, estimate.head.stamp, calibrationMessage(camera_, estimate.head.stamp));
  if (!frame.jpeg.empty()) writer_.write(image_, estimate.head.stamp, imageMessage(frame));
  writer_.write(pose_, estimate.head.stamp, poseMessage(estimate));
  writePath(estimate);
  writer_.write(objects_, estimate.head.stamp, scene_(estimate));
  writer_.write(points_, estimate.head.stamp, pointsMessage(frame));
  writer_.write(diagnostics_, estimate.head.stamp, diagnosticsMessage(frame));
}

/// Writes the path with the first frame of each second. Writing it with every frame would grow with the square of its
/// length.
void DriveMcap::writePath(const FrameEstimate& estimate) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  if (frames_++ % stride_ == 0) way_.push_back(estimate.T_world_cam);
  if (way_.size() > kMostPoses) {
    for (std::size_t i = 0; 2 * i < way_.size(); ++i) way_[i] = way_[2 * i];
    way_.resize((way_.size() + 1) / 2);
    stride_ *= 2;
  }
  const std::int64_t second = estimate.head.stamp.ns / kSecond_ns;
  if (second == path_second_) return;
  path_second_ = second;
  writer_.write(path_, estimate.head.stamp, pathMessage(estimate.head.stamp, way_));
}

}  // namespace motorcade
