#include "io/stream/y4m_header.hpp"

#include <array>
#include <charconv>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::string_view kMagic = "YUV4MPEG2";

/// Samples of both chroma planes (and of a transparency) for a luma plane of `width` by `height`.
struct ChromaLayout {
  std::string_view name;
  std::size_t per_row_divisor, per_column_divisor, planes;
};
constexpr std::array kLayouts{ChromaLayout{"mono", 1, 1, 0}, ChromaLayout{"420", 2, 2, 2},
                              ChromaLayout{"422", 2, 1, 2},  ChromaLayout{"444", 1, 1, 2},
                              ChromaLayout{"411", 4, 1, 2},  ChromaLayout{"444alpha", 1, 1, 3}};

/// A name of a color space begins with that of its layout. It may end with the position of the chroma samples (`jpeg`),
/// or the bits of a sample (`p10`; of `mono`, `10` alone).
struct ColorSpace {
  const ChromaLayout* layout = nullptr;
  int bits = 8;
};

/// Any number up to `most` that fills the text.
std::optional<int> wholeNumber(std::string_view text, int most) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0 || value > most) return std::nullopt;
  return value;
}

std::optional<int> bitsOf(std::string_view suffix, bool mono) {
  if (suffix.empty()) return 8;
  if (!mono && (suffix == "jpeg" || suffix == "mpeg2" || suffix == "paldv")) return 8;
  if (!mono && !suffix.starts_with('p')) return std::nullopt;
  const auto bits = wholeNumber(suffix.substr(mono ? 0 : 1), 16);
  return bits && *bits >= 8 ? bits : std::nullopt;
}

std::optional<ColorSpace> colorSpaceOf(std::string_view name) {
  const ChromaLayout* found = nullptr;
  for (const ChromaLayout& layout : kLayouts)
    if (name.starts_with(layout.name) && (!found || layout.name.size() > found->name.size())) found = &layout;
  if (!found) return std::nullopt;
  const auto bits = bitsOf(name.substr(found->name.size()), found->planes == 0);
  if (!bits) return std::nullopt;
  return ColorSpace{found, *bits};
}

/// `NUMERATOR:DENOMINATOR`; none where either is 0, which says that the rate is not known.
struct Rate {
  bool valid = false;
  std::optional<double> hz{};
};

Rate rateOf(std::string_view text) {
  constexpr int kMost = 1'000'000'000;
  constexpr double kLeast_hz = 0.001, kMost_hz = 100'000;  // as of --fps
  const auto colon = text.find(':');
  if (colon == std::string_view::npos) return {};
  const auto numerator = wholeNumber(text.substr(0, colon), kMost),
             denominator = wholeNumber(text.substr(colon + 1), kMost);
  if (!numerator || !denominator) return {};
  if (*numerator == 0 || *denominator == 0) return {.valid = true};
  const double hz = static_cast<double>(*numerator) / *denominator;
  if (hz < kLeast_hz || hz > kMost_hz) return {};
  return {.valid = true, .hz = hz};
}

/// Reads the fields one by one.
class HeaderReader {
 public:
  explicit HeaderReader(const std::string& name) : name_(name) {}

  void take(std::string_view field) {
    const std::string_view value = field.substr(1);
    switch (field.front()) {
      case 'W':
        header_.width = sizeOf(field, value);
        break;
      case 'H':
        header_.height = sizeOf(field, value);
        break;
      case 'F':
        header_.rate_hz = rateOrFail(field, value);
        break;
      case 'I':
        header_.interlaced = value == "t" || value == "b" || value == "m";
        break;
      case 'C':
        space_ = spaceOrFail(field, value);
        break;
      default:
        break;  // the shape of a pixel (A), which the camera's fx and fy tell, and what others added (X)
    }
  }

  Y4mHeader finish() {
    if (header_.width == 0 || header_.height == 0) fail("tells no width or no height (W, H)");
    const auto divided = [](int size, std::size_t by) { return (static_cast<std::size_t>(size) + by - 1) / by; };
    const ChromaLayout& layout = *space_.layout;
    header_.bits = space_.bits;
    header_.chroma_samples = layout.planes * divided(header_.width, layout.per_row_divisor) *
                             divided(header_.height, layout.per_column_divisor);
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": the stream's header " + what); }

  int sizeOf(std::string_view field, std::string_view value) const {
    constexpr int kMost = 1 << 15;  // of both images together: image_codec's limit of one is half as much
    const auto size = wholeNumber(value, kMost);
    if (!size || *size == 0)
      fail("has " + printable(field) + ": a width or height (W, H) is a number from 1 to " + std::to_string(kMost));
    return *size;
  }
  std::optional<double> rateOrFail(std::string_view field, std::string_view value) const {
    const Rate rate = rateOf(value);
    if (!rate.valid) fail("has " + printable(field) + ": a rate is written as F10:1, from 0.001 to 100000 Hz");
    return rate.hz;
  }
  ColorSpace spaceOrFail(std::string_view field, std::string_view value) const {
    const auto space = colorSpaceOf(value);
    if (!space)
      fail("has " + printable(field) + ", a color space that is not read; write gray, as by" +
           std::string(kY4mCommand));
    return *space;
  }

  std::string name_;
  Y4mHeader header_;
  ColorSpace space_{.layout = &kLayouts[1]};  // where the header tells none, it is 420
};

}  // namespace

Y4mHeader parseY4mHeader(std::string_view line, const std::string& name) {
  if (!line.starts_with(kMagic) || (line.size() > kMagic.size() && line[kMagic.size()] != ' '))
    throw InputError(name + ": is no YUV4MPEG2 stream, it begins with '" + printable(line) + "'; write one, as by" +
                     kY4mCommand);
  HeaderReader reader(name);
  line.remove_prefix(kMagic.size());
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    if (end > 0) reader.take(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return reader.finish();
}

}  // namespace motorcade
