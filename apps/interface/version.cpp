#include "motorcade/motorcade.hpp"

namespace motorcade {

Error::~Error() = default;

const char* version() noexcept { return MOTORCADE_VERSION; }

}  // namespace motorcade
