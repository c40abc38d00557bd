#pragma once

#include <string>
#include <string_view>

namespace motorcade {

/// A word as a shell takes it: as it is where nothing in it is special, else between single quotes.
std::string shellQuoted(std::string_view word);

}  // namespace motorcade
