#pragma once

#include <filesystem>
#include <string_view>

namespace motorcade {

/// Throws InputError for a calibration of a form that is known but not read. The message has the name of the form and
/// what to give in its place.
void throwKnownForm(const std::filesystem::path& file, std::string_view text);

}  // namespace motorcade
