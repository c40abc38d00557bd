// Follows a drive through the shared library and prints the camera's poses as `camera_online.txt` has them. It works in
// the root folder, so that nothing is found by a relative path: module_user DRIVE [SETTINGS]
#include <cstdio>
#include <filesystem>
#include <thread>

#include "motorcade/motorcade.hpp"

namespace {

void print(const motorcade::Result& result) {
  for (std::size_t i = 0; i < result.T_world_cam.size(); ++i)
    std::printf("%s%.9e", i == 0 ? "" : " ", result.T_world_cam[i] + 0.0);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string folder = std::filesystem::absolute(argc > 1 ? argv[1] : "");
  std::filesystem::current_path("/");
  motorcade::Recording drive(folder);
  motorcade::Tracker tracker(drive.camera(),
                             {.policy = motorcade::Tracker::Policy::kReplay, .settings = argc > 2 ? argv[2] : ""});
  const std::jthread camera([&] {
    for (std::int64_t i = 0; i < drive.size(); ++i) tracker.push(drive.read(i));
    tracker.close();
  });
  while (!tracker.done())
    if (const auto result = tracker.wait(std::chrono::seconds(1))) print(*result);
} catch (const motorcade::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
