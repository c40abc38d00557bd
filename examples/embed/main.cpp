// Follows the pairs of a recorded drive in a program of one's own: embed SEQUENCE
// One thread hands pairs in, as a camera's thread would; another takes the results.
#include <cstdio>
#include <exception>
#include <thread>

#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "io/pair_reader.hpp"
#include "io/sequence.hpp"

namespace {

void pushAll(const motorcade::Sequence& sequence, motorcade::Pipeline& pipeline) {
  motorcade::PairReader reader(sequence);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    motorcade::StereoFrame pair;
    pair.stamp = sequence.stamps[i];
    try {
      pair.left = reader.read(sequence.frames[i], motorcade::StereoSide::kLeft);
      pair.right = reader.read(sequence.frames[i], motorcade::StereoSide::kRight);
    } catch (const std::exception& error) {
      pair.problem = error.what();  // a frame without images is bridged
    }
    pipeline.push(std::move(pair));
  }
  pipeline.close();
}

void print(const motorcade::FrameEstimate& frame) {
  const auto& camera = frame.T_world_cam.translation();
  std::printf("%lld: camera at %.2f %.2f %.2f m\n", static_cast<long long>(frame.frame.value), camera.x(), camera.y(),
              camera.z());
  for (const motorcade::ObjectEstimate& object : frame.objects) {
    const Eigen::Vector3d p_cam = frame.T_world_cam.inverse() * object.T_world_body.translation();
    std::printf("  object %d: %.1f m ahead, %.1f m to the right, %.1f +- %.1f m/s\n", object.track.value, p_cam.z(),
                p_cam.x(), object.velocity_world_mps.norm(), object.speed_sigma_mps);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw std::invalid_argument("usage: embed SEQUENCE");
  const motorcade::Sequence sequence = motorcade::openSequence(argv[1]);
  motorcade::PipelineConfig config;  // .pipeline.policy = kLive: the newest pair wins, and push never waits
  motorcade::Pipeline pipeline(config.pipeline, motorcade::makeStages(config, sequence.camera));
  std::jthread camera([&] { pushAll(sequence, pipeline); });
  while (const auto result = pipeline.next()) print(result->online);
  std::printf("%lld pairs\n", static_cast<long long>(pipeline.finish().summary.processed));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
