#pragma once

#include <filesystem>
#include <string>
#include <string_view>

/// Files that are no image that is read: what they are, and what makes one of them.
namespace motorcade {

/// A sentence with a command that writes the images of the file's folder anew, in gray.
std::string conversionOf(const std::filesystem::path& file);

/// Throws InputError that names what lies in a file, by its first bytes.
[[noreturn]] void failForeign(std::string_view bytes, const std::filesystem::path& file);

}  // namespace motorcade
