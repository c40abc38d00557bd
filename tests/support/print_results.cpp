// Prints each number of a drive's results with all its bits: print_results DRIVE [FRAMES [THREADS]]. For comparisons
// between processors.
#include <algorithm>
#include <cstdio>
#include <string>
#include <thread>

#include <motorcade/motorcade.hpp>

namespace {

template <class Numbers>
void print(const char* name, const Numbers& numbers) {
  std::printf(" %s", name);
  for (const double number : numbers) std::printf(" %a", number);
}

void print(const motorcade::Result& result) {
  std::printf("frame %lld %d %d", static_cast<long long>(result.frame), static_cast<int>(result.status),
              static_cast<int>(result.cause));
  print("pose", result.T_world_cam);
  print("velocity", result.velocity);
  if (result.motion_covariance) print("covariance", *result.motion_covariance);
  std::printf("\n");
  for (const auto& object : result.objects) {
    std::printf("object %lld %d %d", static_cast<long long>(object.id), static_cast<int>(object.state), object.points);
    print("pose", object.T_cam_body);
    print("velocity", object.velocity_world_mps);
    print("covariance", object.velocity_covariance);
    print("box", object.box_size_m);
    std::printf(" mask %zu\n", object.mask ? object.mask->inside.size() : 0);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  motorcade::Recording drive(argc > 1 ? argv[1] : "");
  const std::int64_t frames = argc > 2 ? std::min<std::int64_t>(std::stoll(argv[2]), drive.size()) : drive.size();
  motorcade::Tracker::Options options{.policy = motorcade::Tracker::Policy::kReplay, .masks = true};
  if (argc > 3) options.threads = std::stoi(argv[3]);
  motorcade::Tracker tracker(drive.camera(), options);
  std::jthread camera([&] {
    for (std::int64_t i = 0; i < frames; ++i) tracker.push(drive.read(i));
    tracker.close();
  });
  while (!tracker.done())
    if (const auto result = tracker.wait(std::chrono::seconds(1))) print(*result);
  return 0;
} catch (const motorcade::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
