#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>

#include "io/image_codec.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr int kWhite = 255, kMaxValue = 65535;  // of our images, and of the format

bool isPgm(std::string_view bytes) { return bytes.starts_with("P5") || bytes.starts_with("P2"); }

struct PgmHeader {
  ImageSize size;
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

PgmHeader pgmHeader(std::string_view bytes, const fs::path& file) {
  std::size_t at = 2;
  const auto width = pgmNumber(bytes, at), height = pgmNumber(bytes, at), max_value = pgmNumber(bytes, at);
  if (!width || !height || !max_value || *max_value < 1 || *max_value > kMaxValue)
    failDamaged(file, "its PGM header is cut or wrong");
  return {checkedSize(static_cast<std::uint64_t>(*width), static_cast<std::uint64_t>(*height), file), *max_value,
          at + 1, bytes[1] == '5'};
}

ImageSize pgmSize(std::string_view bytes, const fs::path& file) { return pgmHeader(bytes, file).size; }

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

Image decodePgm(std::string_view bytes, const fs::path& file, ImagePool& pool) {
  const PgmHeader header = pgmHeader(bytes, file);
  const std::size_t width = header.size.width, height = header.size.height;
  const std::size_t least_bytes = header.binary ? width * height * header.sampleBytes()
                                                : 2 * width * height - 1;  // a digit each, and what separates them
  if (bytes.size() < header.data_at + least_bytes) failDamaged(file, "the file ends early");
  Image image = pool.acquire(header.size.width, header.size.height);
  if (header.binary && header.max_value == kWhite) {
    for (std::size_t y = 0; y < height; ++y)
      std::memcpy(image.mutableRow(y), bytes.data() + header.data_at + y * width, width);
    return image;
  }
  PgmSamples samples(bytes, header, file);
  for (int y = 0; y < header.size.height; ++y)
    for (int x = 0; x < header.size.width; ++x)
      image.mutableRow(y)[x] =
          static_cast<std::uint8_t>(std::min(samples.next(), header.max_value) * kWhite / header.max_value);
  return image;
}

}  // namespace

const ImageCodec& pgmCodec() {
  static constexpr ImageCodec kCodec{ImageFormat::kPgm, isPgm, pgmSize, decodePgm};
  return kCodec;
}

}  // namespace motorcade
