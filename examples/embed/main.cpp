// Follows a recorded drive and prints each object's velocity with its covariance: embed DRIVE
#include <cstdio>
#include <thread>

#include <motorcade/motorcade.hpp>

void print(const motorcade::Result& result) {
  const auto& T = result.T_world_cam;  // three rows of four
  std::printf("%lld: camera at %.2f %.2f %.2f m\n", static_cast<long long>(result.frame), T[3], T[7], T[11]);
  for (const auto& object : result.objects) {
    const auto& v = object.velocity_world_mps;
    const auto& c = object.velocity_covariance;  // of x, y, z, row by row
    std::printf("  object %lld: %.1f m ahead, velocity %.1f %.1f m/s, covariance %.3f %.3f %.3f\n",
                static_cast<long long>(object.id), object.T_cam_body[11], v[0], v[2], c[0], c[2], c[8]);
  }
}

int main(int argc, char** argv) try {
  motorcade::Recording drive(argc == 2 ? argv[1] : "");
  motorcade::Tracker tracker(drive.camera(), {.policy = motorcade::Tracker::Policy::kReplay});
  std::jthread camera([&] {  // hands pairs in, as a camera's thread would
    for (std::int64_t i = 0; i < drive.size(); ++i) tracker.push(drive.read(i));
    tracker.close();
  });
  while (!tracker.done())
    if (const auto result = tracker.wait(std::chrono::seconds(1))) print(*result);
} catch (const motorcade::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
