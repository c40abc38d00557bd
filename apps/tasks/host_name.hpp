#pragma once

#include <string>

namespace motorcade {

/// Of this machine, as others know it.
std::string hostName();

}  // namespace motorcade
