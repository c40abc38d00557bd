#pragma once

#include <string>

namespace motorcade {

/// Name of this machine, as others know it.
std::string hostName();

}  // namespace motorcade
