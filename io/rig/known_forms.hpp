#pragma once

#include <filesystem>
#include <string_view>

namespace motorcade {

/// Throws InputError with the name of the form and what to give in its place, where a calibration's text is of a form
/// that is known but not read; else returns.
void throwKnownForm(const std::filesystem::path& file, std::string_view text);

}  // namespace motorcade
