#include <algorithm>
#include <new>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "apps/run/object_view_writer.hpp"

namespace motorcade {
namespace {

constexpr std::uint8_t kFilterUp = 2;  // of a PNG's rows: bytes are differences to those above

/// The first bytes of a PNG; of a zlib stream; the empty block that ends one.
constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8), kStreamStart("\x78\x9c", 2), kStreamEnd("\x03\x00", 2);

void appendBigEndian(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift);
}

const Bytef* forZlib(const char* bytes) { return reinterpret_cast<const Bytef*>(bytes); }

void appendChunk(std::string& png, std::string_view name, std::string_view data) {
  appendBigEndian(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = png.size();
  png += name;
  png += data;
  const auto checked_bytes = static_cast<uInt>(png.size() - start);
  appendBigEndian(png, static_cast<std::uint32_t>(crc32(0, forZlib(png.data() + start), checked_bytes)));
}

std::string headerOf(int width_px, int height_px) {
  std::string header;
  appendBigEndian(header, static_cast<std::uint32_t>(width_px));
  appendBigEndian(header, static_cast<std::uint32_t>(height_px));
  constexpr std::string_view kGrayOf16Bits("\x10\x00\x00\x00\x00", 5);  // packed, filtered as all are, not interlaced
  return header += kGrayOf16Bits;
}

/// True when a row equals the one above; above the first there are zeros.
bool isRepeated(const Gray16Image& mask, int row) {
  const auto start = mask.pixels.begin() + std::ptrdiff_t{row} * mask.width, end = start + mask.width;
  if (row == 0) return std::all_of(start, end, [](std::uint16_t value) { return value == 0; });
  return std::equal(start, end, start - mask.width);
}

/// Writes the differences of a row's values to those above.
void writeRow(const std::uint16_t* values, const std::uint16_t* above, int width_px, std::uint8_t* to) {
  *to++ = kFilterUp;
  for (int u = 0; u < width_px; ++u) {
    to[2 * u] = static_cast<std::uint8_t>((values[u] >> 8) - (above[u] >> 8));
    to[2 * u + 1] = static_cast<std::uint8_t>(values[u] - above[u]);
  }
}

}  // namespace

/// Makes independent parts of a deflate stream.
class PartPacker {
 public:
  /// `level` as zlib counts them: 1 is fast, 9 packs best.
  explicit PartPacker(int level) {
    constexpr int kNoHeader = -MAX_WBITS, kLittleMemory = 5;  // which is cleared after each part
    if (deflateInit2(&stream_, level, Z_DEFLATED, kNoHeader, kLittleMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~PartPacker() { deflateEnd(&stream_); }
  PartPacker(const PartPacker&) = delete;
  PartPacker& operator=(const PartPacker&) = delete;

  std::string operator()(const std::vector<std::uint8_t>& bytes) {
    constexpr uLong kFlush_bytes = 16;  // more than what a flush adds
    const uLong most_bytes = deflateBound(&stream_, static_cast<uLong>(bytes.size())) + kFlush_bytes;
    std::string packed(most_bytes, '\0');
    stream_.next_in = const_cast<Bytef*>(bytes.data());  // zlib only reads it
    stream_.avail_in = static_cast<uInt>(bytes.size());
    stream_.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream_.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream_, Z_FULL_FLUSH);
    return packed.substr(0, packed.size() - stream_.avail_out);
  }

 private:
  z_stream stream_{};
};

MaskPacker::MaskPacker(int width_px, int height_px)
    : width_px_(width_px),
      height_px_(height_px),
      row_bytes_(1 + 2 * static_cast<std::size_t>(width_px)),
      packer_(std::make_unique<PartPacker>(1)) {
  PartPacker thorough(6);
  for (std::size_t count = 1; std::cmp_less_equal(count, height_px); count *= 2) {
    std::vector<std::uint8_t> rows(count * row_bytes_, 0);
    for (std::size_t row = 0; row < count; ++row) rows[row * row_bytes_] = kFilterUp;
    repeated_.push_back(packed(thorough, rows));
  }
}

MaskPacker::~MaskPacker() = default;

MaskPacker::Part MaskPacker::packed(PartPacker& packer, const std::vector<std::uint8_t>& bytes) {
  return {.packed = packer(bytes),
          .unpacked_bytes = bytes.size(),
          .checksum = static_cast<std::uint32_t>(adler32(1, bytes.data(), static_cast<uInt>(bytes.size())))};
}

MaskPacker::Part MaskPacker::changedRows(const Gray16Image& mask, int first, int end) {
  const auto count = static_cast<std::size_t>(end - first);
  std::vector<std::uint8_t> rows(count * row_bytes_);
  const std::vector<std::uint16_t> zeros(width_px_, 0);
  for (int row = first; row < end; ++row) {
    const std::uint16_t* values = mask.pixels.data() + std::ptrdiff_t{row} * width_px_;
    writeRow(values, row > 0 ? values - width_px_ : zeros.data(), width_px_, &rows[(row - first) * row_bytes_]);
  }
  return packed(*packer_, rows);
}

std::string MaskPacker::operator()(const Gray16Image& mask) {
  std::string stream(kStreamStart);
  uLong checksum = 1;
  const auto append = [&](const Part& part) {
    stream += part.packed;
    checksum = adler32_combine(checksum, part.checksum, static_cast<z_off_t>(part.unpacked_bytes));
  };
  for (int first = 0, end = 0; first < height_px_; first = end) {
    const bool repeated = isRepeated(mask, first);
    for (end = first + 1; end < height_px_ && isRepeated(mask, end) == repeated;) ++end;
    if (!repeated) append(changedRows(mask, first, end));
    for (std::size_t k = 0; repeated && k < repeated_.size(); ++k)
      if ((end - first) >> k & 1) append(repeated_[k]);
  }
  stream += kStreamEnd;
  appendBigEndian(stream, static_cast<std::uint32_t>(checksum));
  std::string png(kSignature);
  appendChunk(png, "IHDR", headerOf(width_px_, height_px_));
  appendChunk(png, "IDAT", stream);
  appendChunk(png, "IEND", {});
  return png;
}

}  // namespace motorcade
