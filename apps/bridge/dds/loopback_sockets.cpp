#include "apps/bridge/dds/loopback_sockets.hpp"

#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>

#include <netinet/in.h>
#include <sys/socket.h>

namespace motorcade {
namespace {

constexpr char kLoopbackDevice[] = "lo";

std::optional<int> descriptorOf(const std::filesystem::path& name) {
  const std::string text = name.filename().string();
  int descriptor = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), descriptor);
  return error == std::errc() ? std::optional(descriptor) : std::nullopt;
}

bool receivesAnywhere(int descriptor) {
  int type = 0;
  socklen_t size = sizeof(type);
  if (::getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM) return false;
  sockaddr_storage name{};
  size = sizeof(name);
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&name), &size) != 0 || name.ss_family != AF_INET)
    return false;
  sockaddr_in address{};
  std::memcpy(&address, &name, sizeof(address));
  return address.sin_addr.s_addr == htonl(INADDR_ANY);
}

}  // namespace

bool bindSocketsToLoopback() {
  bool bound = true;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const auto descriptor = descriptorOf(entry.path());
    if (!descriptor || !receivesAnywhere(*descriptor)) continue;
    bound &= ::setsockopt(*descriptor, SOL_SOCKET, SO_BINDTODEVICE, kLoopbackDevice, sizeof(kLoopbackDevice)) == 0;
  }
  return bound;
}

}  // namespace motorcade
