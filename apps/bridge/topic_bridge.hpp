#pragma once

#include "apps/bridge/bridge_command.hpp"

namespace motorcade {

/// Follows the topics of `--images` until a signal, or the number of pairs that was asked for. Gives the exit code;
/// failures are UserErrors.
int runTopicBridge(const BridgeOptions& options);

}  // namespace motorcade
