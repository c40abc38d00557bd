#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>

#include "io/images/image_codec.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr int kWhite = 255, kMaxValue = 65535;  // of our images, and of the format

/// "P5" or, in digits, "P2" of gray, "P6" or "P3" of colors.
bool isPgm(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' && std::string_view("2356").find(bytes[1]) != std::string_view::npos &&
         (std::isspace(static_cast<unsigned char>(bytes[2])) || bytes[2] == '#');
}

struct PgmHeader {
  ImageSize size;
  int channels = 1;
  int max_value = 0;
  std::size_t data_at = 0;
  bool binary = true;

  std::size_t sampleBytes() const { return max_value > kWhite ? 2 : 1; }
};

/// The next number of a PGM header or of ASCII data; '#' starts a comment.
std::optional<int> pgmNumber(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (std::isspace(static_cast<unsigned char>(bytes[at])) || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
    ++at;
  }
  int value = 0, digits = 0;
  for (; at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])) && digits < 9; ++at, ++digits)
    value = value * 10 + (bytes[at] - '0');
  return digits > 0 ? std::optional(value) : std::nullopt;
}

PgmHeader wholeHeader(std::string_view bytes, const fs::path& file) {
  std::size_t at = 2;
  const auto width = pgmNumber(bytes, at), height = pgmNumber(bytes, at), max_value = pgmNumber(bytes, at);
  if (!width || !height || !max_value || *max_value < 1 || *max_value > kMaxValue)
    failDamaged(file, "its PGM header is cut or wrong");
  const char kind = bytes[1];
  return {.size = checkedSize(static_cast<std::uint64_t>(*width), static_cast<std::uint64_t>(*height), file),
          .channels = kind == '3' || kind == '6' ? 3 : 1,
          .max_value = *max_value,
          .data_at = at + 1,
          .binary = kind == '5' || kind == '6'};
}

ImageHeader pgmHeader(std::string_view bytes, const fs::path& file) {
  const PgmHeader header = wholeHeader(bytes, file);
  const bool deep = header.max_value > kWhite;
  return {.size = header.size,
          .channels = header.channels,
          .bits = deep ? kAllSampleBits : 8,
          .white = deep && header.max_value != kMaxValue ? header.max_value : 0};
}

/// Takes samples that are not plain bytes one by one: two bytes, or digits.
class PgmSamples {
 public:
  PgmSamples(std::string_view bytes, const PgmHeader& header, const fs::path& file)
      : bytes_(bytes), header_(header), file_(file), at_(header.data_at) {}

  int next() { return header_.binary ? nextBinary() : nextDigits(); }

 private:
  int nextBinary() {
    int value = 0;
    for (std::size_t i = 0; i < header_.sampleBytes(); ++i)
      value = value << 8 | static_cast<std::uint8_t>(bytes_[at_++]);
    return value;
  }
  int nextDigits() {
    const auto number = pgmNumber(bytes_, at_);
    if (!number) failDamaged(file_, "the file ends early");
    return *number;
  }

  std::string_view bytes_;
  const PgmHeader& header_;
  const fs::path& file_;
  std::size_t at_;
};

/// The samples of a whole file, one by one.
PgmSamples samplesOf(std::string_view bytes, const PgmHeader& header, const fs::path& file) {
  const std::size_t samples = std::size_t{1} * header.channels * header.size.width * header.size.height;
  const std::size_t least_bytes =
      header.binary ? samples * header.sampleBytes() : 2 * samples - 1;  // a digit each, and what separates them
  if (bytes.size() < header.data_at + least_bytes) failDamaged(file, "the file ends early");
  return {bytes, header, file};
}

int brightestOfPgm(std::string_view bytes, const fs::path& file) {
  const PgmHeader header = wholeHeader(bytes, file);
  PgmSamples samples = samplesOf(bytes, header, file);
  int brightest = 0;
  for (std::int64_t left = std::int64_t{1} * header.channels * header.size.width * header.size.height; left > 0; --left)
    brightest = std::max(brightest, samples.next());
  return std::min(brightest, kMaxValue);
}

Image decodePgm(std::string_view bytes, const fs::path& file, ImagePool& pool, int sample_bits) {
  const PgmHeader header = wholeHeader(bytes, file);
  PgmSamples samples = samplesOf(bytes, header, file);
  const std::size_t width = header.size.width, height = header.size.height;
  Image image = pool.acquire(header.size.width, header.size.height);
  if (header.binary && header.max_value == kWhite && header.channels == 1) {
    for (std::size_t y = 0; y < height; ++y)
      std::memcpy(image.mutableRow(y), bytes.data() + header.data_at + y * width, width);
    return image;
  }
  const bool as_told = header.max_value <= kWhite || sample_bits == kAllSampleBits;
  const auto next = [&]() -> int {
    const int sample = std::min(samples.next(), header.max_value);
    return as_told ? sample * kWhite / header.max_value : upperBits(static_cast<unsigned>(sample), sample_bits);
  };
  for (int y = 0; y < header.size.height; ++y) {
    for (int x = 0; x < header.size.width; ++x) {
      const int first = next();
      if (header.channels == 1) {
        image.mutableRow(y)[x] = static_cast<std::uint8_t>(first);
      } else {
        const int green = next(), blue = next();
        image.mutableRow(y)[x] = grayOf(first, green, blue);
      }
    }
  }
  return image;
}

}  // namespace

const ImageCodec& pgmCodec() {
  static constexpr ImageCodec kCodec{ImageFormat::kPgm, isPgm, pgmHeader, decodePgm, brightestOfPgm};
  return kCodec;
}

}  // namespace motorcade
