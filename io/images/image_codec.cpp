#include "io/images/image_codec.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/text_file.hpp"
#include "io/images/image_limits.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Advice on turning a foreign file into images that can be read.
enum class Mend { kConvertFolder, kSplitVideo, kNone };

struct ForeignFormat {
  std::size_t at;  // where in the file its mark stands
  std::string_view mark;
  const char* name;  // with its article
  Mend mend = Mend::kConvertFolder;
};

using std::literals::string_view_literals::operator""sv;
constexpr std::array kForeignFormats = {
    ForeignFormat{0, "II*\0"sv, "a TIFF or raw image"},
    ForeignFormat{0, "MM\0*"sv, "a TIFF or raw image"},
    ForeignFormat{0, "II+\0"sv, "a BigTIFF image"},
    ForeignFormat{8, "WEBP"sv, "a WebP image"},
    ForeignFormat{8, "AVI "sv, "an AVI video", Mend::kSplitVideo},
    ForeignFormat{0, "GIF8"sv, "a GIF image"},
    ForeignFormat{4, "jP  "sv, "a JPEG 2000 image"},
    ForeignFormat{0, "\xFF\x4F\xFF\x51"sv, "a JPEG 2000 image"},
    ForeignFormat{4, "JXL "sv, "a JPEG XL image"},
    ForeignFormat{0, "\xFF\x0A"sv, "a JPEG XL image"},
    ForeignFormat{4, "ftypavif"sv, "an AVIF image"},
    ForeignFormat{4, "ftyphei"sv, "a HEIF image"},
    ForeignFormat{4, "ftypmif1"sv, "a HEIF image"},
    ForeignFormat{4, "ftypcrx"sv, "a Canon raw image"},
    ForeignFormat{4, "ftyp"sv, "an MP4 or QuickTime video", Mend::kSplitVideo},
    ForeignFormat{0, "\x1A\x45\xDF\xA3"sv, "a Matroska or WebM video", Mend::kSplitVideo},
    ForeignFormat{0, "\x76\x2F\x31\x01"sv, "an OpenEXR image"},
    ForeignFormat{0, "P1"sv, "a black-and-white PBM image"},
    ForeignFormat{0, "P4"sv, "a black-and-white PBM image"},
    ForeignFormat{0, "P7"sv, "a PAM image"},
    ForeignFormat{0, "PF"sv, "a PFM image of floating-point numbers"},
    ForeignFormat{0, "Pf"sv, "a PFM image of floating-point numbers"},
    ForeignFormat{0, "qoif"sv, "a QOI image"},
    ForeignFormat{0, "BM"sv, "a BMP image"},
    ForeignFormat{0, "\x93NUMPY"sv, "a numpy array", Mend::kNone},
    ForeignFormat{0, "SIMPLE  ="sv, "a FITS image"},
    ForeignFormat{0, "\x1F\x8B"sv, "a gzip archive: unpack it", Mend::kNone},
    ForeignFormat{0, "PK\x03\x04"sv, "a zip archive: unpack it", Mend::kNone},
    ForeignFormat{0, "version https://git-lfs"sv, "a pointer of Git LFS, not the image: run git lfs pull where it is",
                  Mend::kNone},
    ForeignFormat{0, "<!DOCTYPE"sv, "a web page, as a failed download leaves: load the image anew", Mend::kNone},
    ForeignFormat{0, "<html"sv, "a web page, as a failed download leaves: load the image anew", Mend::kNone},
    ForeignFormat{0, "<?xml"sv, "an XML file, no image", Mend::kNone},
};

const ForeignFormat* foreignFormatOf(std::string_view bytes) {
  const auto found = std::ranges::find_if(kForeignFormats, [&](const ForeignFormat& format) {
    return bytes.size() > format.at && bytes.substr(format.at).starts_with(format.mark);
  });
  return found == kForeignFormats.end() ? nullptr : &*found;
}

/// All files of the folder that have the same end of their names.
std::string likeIt(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::string end = file.extension().string();
  const bool plain = std::ranges::all_of(end, [](unsigned char c) { return c == '.' || std::isalnum(c); });
  return shellWord(folder.string()) + "/*" + (plain ? end : "");
}

std::string mendOf(Mend mend, const fs::path& file) {
  switch (mend) {
    case Mend::kConvertFolder:
      return "; images are read from PNG, JPEG and PGM files. " + conversionOf(file);
    case Mend::kSplitVideo:
      return "; write its pictures as files:\n  ffmpeg -i " + shellWord(file.string()) +
             " -pix_fmt gray DRIVE/left/%06d.png";
    case Mend::kNone:
      break;
  }
  return "";
}

}  // namespace

/// Converts files whose names say image in place: beside new ones they would be images of their own.
std::string conversionOf(const fs::path& file) {
  const bool replaced = hasImageName(file);
  const std::string format = replaced ? file.extension().string().substr(1) : "png";
  return std::string("ImageMagick converts those of a folder, here and in that of the other camera") +
         (replaced ? " (it replaces them: keep a copy)" : "") + ":\n  mogrify -format " + format +
         " -colorspace Gray " + likeIt(file);
}

void failForeign(std::string_view bytes, const fs::path& file) {
  if (bytes.empty()) throw InputError(file.string() + ": is neither PNG, JPEG nor PGM; the file is empty");
  const ForeignFormat* const format = foreignFormatOf(bytes);
  if (!format)
    throw InputError(file.string() +
                     ": is neither PNG, JPEG nor PGM; a raw dump of pixels has no size in it, write it as PNG or PGM");
  throw InputError(file.string() + ": is " + format->name + mendOf(format->mend, file));
}

void failUnsupported(const fs::path& file, const std::string& kind) {
  throw InputError(file.string() + ": is " + kind + ", which is not read. " + conversionOf(file));
}

namespace {

constexpr int kMinSide_px = 16, kMaxSide_px = 16384;

}  // namespace

std::string readImageBytes(const std::filesystem::path& file, int max_mb) {
  constexpr std::size_t kMegabyte = std::size_t{1} << 20;
  return readWhole(file, static_cast<std::size_t>(max_mb) * kMegabyte);
}

ImageSize checkedSize(std::uint64_t width, std::uint64_t height, const std::filesystem::path& file) {
  const auto bad = [](std::uint64_t side) { return side < kMinSide_px || side > kMaxSide_px; };
  if (bad(width) || bad(height)) {
    throw InputError(file.string() + ": its header tells " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels; each side must lie between " + std::to_string(kMinSide_px) + " and " +
                     std::to_string(kMaxSide_px));
  }
  if (width * height > kMaxImage_pixels) {
    throw InputError(file.string() + ": its header tells " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels, more than " + std::to_string(kMaxImage_pixels) + "; make the images smaller");
  }
  return {static_cast<int>(width), static_cast<int>(height)};
}

[[noreturn]] void failDamaged(const std::filesystem::path& file, const std::string& why) {
  throw InputError(file.string() + ": damaged image: " + why);
}

std::vector<std::uint8_t*> rowPointers(std::uint8_t* first, int height, std::size_t stride) {
  std::vector<std::uint8_t*> rows(height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = first + y * stride;
  return rows;
}

}  // namespace motorcade
