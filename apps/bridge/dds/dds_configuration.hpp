#pragma once

#include <string>

namespace motorcade {

/// The domain and the interface on which DDS communicates.
struct DdsPlace {
  static constexpr int kMostDomain = 232;  // its ports would be beyond 65535

  int domain = 0;
  std::string interface {};  // IPv4 address or name of the one interface; empty: loopback
};

/// Cyclone DDS' configuration for that place alone, whatever the environment says. Loopback has no multicast:
/// participants are sought at the ports of the first 33, as ROS 2 does where discovery is for the machine alone. Other
/// interfaces use multicast. Throws UsageError.
std::string ddsConfiguration(const DdsPlace& place);

bool isLoopback(const DdsPlace& place);

/// Text for messages: "domain 0 on 127.0.0.1".
std::string textOf(const DdsPlace& place);

/// Binds this process' UDP sockets of Cyclone DDS to the loopback device, so that nobody outside of this machine can
/// reach them. Cyclone DDS sends from the address of its interface, but receives at any address of the machine. False
/// where the system refuses (before Linux 5.7, without privilege).
bool bindSocketsToLoopback();

}  // namespace motorcade
