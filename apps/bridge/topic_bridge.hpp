#pragma once

#include "apps/bridge/bridge_command.hpp"

namespace motorcade {

/// Follows the topics of `--images` until a signal comes, or the wanted number of pairs. Returns the exit code;
/// failures are UserErrors.
int runTopicBridge(const BridgeOptions& options);

}  // namespace motorcade
