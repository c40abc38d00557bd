#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// Derives from the names of images which of them are a pair and in what order pairs follow. If the names are times,
/// they also give the capture times.
namespace motorcade {

/// A name without its extension, cut into text and digits in turn, text first: `cam0_0012` is cam, 0, _, 0012.
using NameParts = std::vector<std::string>;
NameParts partsOfName(std::string_view name);

/// The number at the end of an image's name; empty where there is none.
std::optional<std::int64_t> imageNumber(const std::filesystem::path& image);

/// The images of one side.
struct NamedImages {
  std::vector<std::filesystem::path> images{};  // in natural order
  std::vector<NameParts> names{};               // of each
  std::vector<std::filesystem::path> strays{};  // a few whose names are of another kind than all others
  bool alike = true;                            // all names have the same text: they differ in digits alone
};
NamedImages namedImages(const std::vector<std::filesystem::path>& images);

/// Digits that differ from name to name, as indices of parts.
std::set<std::size_t> varyingDigits(const std::vector<NameParts>& names);

using ImagesByNumber = std::map<std::int64_t, std::filesystem::path>;

enum class NameKind {
  kNames,    // equal or not; the numbers are places in natural order
  kNumbers,  // that count
  kTimes     // in nanoseconds
};

/// Both sides, keyed by what their names tell.
struct KeyedImages {
  NameKind kind = NameKind::kNames;
  ImagesByNumber left{}, right{};
};
/// Throws InputError where two images of a side have the same number or time.
KeyedImages keyedImages(const NamedImages& left, const NamedImages& right);

/// The name of an image's missing partner on the other side, derived from the image's own.
std::filesystem::path expectedImage(const NamedImages& side, const NamedImages& other,
                                    const std::filesystem::path& partner);

/// Times that the names of images tell.
struct NameTimes {
  std::vector<std::int64_t> all_ns;  // of each name
  std::int64_t unit_ns = 1;          // of the numbers in the names; a second where they have a fraction, or are dates
};

/// Reads the times in the names of one side, which have the same text and come in natural order. They are dates with a
/// time of day, seconds with a fraction, or whole numbers of nanoseconds, microseconds, milliseconds or seconds. The
/// unit is the one by which the numbers lie within this century or the images are as far apart as a camera's. Numbers
/// that merely count are no times. Empty where the names do not give times that all differ.
std::optional<NameTimes> timesOfNames(const std::vector<NameParts>& names);

}  // namespace motorcade
