#include "apps/tasks/host_name.hpp"

#include <unistd.h>

namespace motorcade {

std::string hostName() {
  char name[256] = {};
  return ::gethostname(name, sizeof(name) - 1) == 0 ? name : "unknown";
}

}  // namespace motorcade
