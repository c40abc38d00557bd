#pragma once

#include <filesystem>
#include <string>
#include <string_view>

/// Files that are not read as images: what they are, and how to convert them.
namespace motorcade {

/// A sentence with a command that converts the images of the file's folder to gray ones that are read.
std::string conversionOf(const std::filesystem::path& file);

/// Throws InputError that names the content of a file by its first bytes.
[[noreturn]] void failForeign(std::string_view bytes, const std::filesystem::path& file);

}  // namespace motorcade
