#pragma once

#include <exception>
#include <string>

#include "apps/pipeline/log_callback.hpp"

namespace motorcade {

/// Calls a callback for `what`. Its exceptions are logged and do not prevent the next call.
template <class Call>
void callLogged(const LogCallback& log, const char* what, const Call& call) {
  const auto complain = [&](const char* why) {
    tell(log, LogLevel::kError, [&] { return std::string("the callback for ") + what + ": " + why; });
  };
  try {
    call();
  } catch (const std::exception& error) {
    complain(error.what());
  } catch (...) {
    complain("it threw what is no std::exception");
  }
}

}  // namespace motorcade
