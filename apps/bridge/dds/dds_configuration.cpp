#include "apps/bridge/dds/dds_configuration.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr const char* kLoopback = "127.0.0.1";

bool isAddress(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

/// True for the address of one of this machine's interfaces.
bool isOwnAddress(const std::string& text) {
  ifaddrs* interfaces = nullptr;
  in_addr wanted{};
  if (getifaddrs(&interfaces) != 0 || inet_pton(AF_INET, text.c_str(), &wanted) != 1) return false;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(interfaces, freeifaddrs);
  for (const ifaddrs* each = interfaces; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, each->ifa_addr, sizeof(address));
    if (address.sin_addr.s_addr == wanted.s_addr) return true;
  }
  return false;
}

/// The attribute of an XML element that names the interface. It has no character with a meaning in XML.
std::string attributeOf(const std::string& interface) {
  if (isOwnAddress(interface)) return fmt::format("address=\"{}\"", interface);
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-';
  };
  if (isAddress(interface) || !std::ranges::all_of(interface, plain) || if_nametoindex(interface.c_str()) == 0)
    throw UsageError("--interface " + printable(interface) +
                     ": no interface of this machine; write its IPv4 address or its name, such as 192.168.0.7 or eth0");
  return fmt::format("name=\"{}\"", interface);
}

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

bool isLoopback(const DdsPlace& place) {
  const std::string& interface = place.interface;
  return interface.empty() || interface == "lo" || (isAddress(interface) && interface.starts_with("127."));
}

std::string ddsConfiguration(const DdsPlace& place) {
  if (place.domain < 0 || place.domain > DdsPlace::kMostDomain)
    throw UsageError(fmt::format("--domain {}: it is 0 to {}", place.domain, DdsPlace::kMostDomain));
  const bool loopback = isLoopback(place);
  const std::string interface =
      loopback ? fmt::format("address=\"{}\" multicast=\"false\"", kLoopback) : attributeOf(place.interface);
  const std::string multicast = loopback ? "<AllowMulticast>false</AllowMulticast>" : "";
  const std::string discovery = loopback ? fmt::format(
                                               "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
                                               "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
                                               "<Peers><Peer address=\"{}\"/></Peers></Discovery>",
                                               kLoopback)
                                         : "";
  // The writers' histories bound what is not acknowledged yet. By default writers wait from 30 kB on, which is one
  // array of markers, and for a second when they are deleted. They also ask for acknowledgments only every 100 ms, in
  // which a replay at full speed fills the history. A pair of images comes at once, faster than it is read from the
  // socket. The buffer is therefore as large as the system allows (net.core.rmem_max). No image is larger than the
  // largest sample.
  return "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface " + interface + "/></Interfaces>" +
         multicast + "</General>" + discovery +
         "<Internal><Watermarks><WhcAdaptive>false</WhcAdaptive><WhcHigh>64 MB</WhcHigh></Watermarks>"
         "<HeartbeatInterval min=\"5 ms\" minsched=\"5 ms\">10 ms</HeartbeatInterval>"
         "<WriterLingerDuration>0 s</WriterLingerDuration><SocketReceiveBufferSize max=\"32 MB\"/>"
         "<MaxSampleSize>256 MB</MaxSampleSize></Internal>"
         "</Domain></CycloneDDS>";
}

std::string textOf(const DdsPlace& place) {
  return fmt::format("domain {} on {}", place.domain, isLoopback(place) ? kLoopback : place.interface);
}

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
