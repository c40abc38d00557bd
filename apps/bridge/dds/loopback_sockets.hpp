#pragma once

namespace motorcade {

/// Binds this process' UDP sockets of Cyclone DDS to the loopback device, so that nobody outside of this machine can
/// reach them. Cyclone DDS sends from the address of its interface, but receives at any address of the machine. False
/// where the system refuses (before Linux 5.7, without privilege).
bool bindSocketsToLoopback();

}  // namespace motorcade
