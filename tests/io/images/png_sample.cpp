#include "tests/io/images/png_sample.hpp"

#include <cmath>
#include <random>

#include <zlib.h>

namespace motorcade::test {
namespace {

constexpr std::size_t kSignature_bytes = 8;

const Bytef* bytesOf(std::string_view text) { return reinterpret_cast<const Bytef*>(text.data()); }

std::string bigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

std::string signature() { return "\x89PNG\r\n\x1a\n"; }

void append(png_structp png, png_bytep bytes, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), count);
}

std::vector<std::vector<std::uint8_t>> rowsOf(const PngSample& sample, std::size_t row_bytes) {
  std::mt19937 random(7);
  std::vector<std::vector<std::uint8_t>> rows(sample.height, std::vector<std::uint8_t>(row_bytes));
  for (int y = 0; y < sample.height; ++y) {
    for (std::size_t x = 0; x < row_bytes; ++x) {
      const double smooth = 128 + 90 * std::sin(0.07 * static_cast<double>(x)) * std::cos(0.11 * y);
      const bool noisy = x > row_bytes / 2;
      rows[y][x] = static_cast<std::uint8_t>(noisy ? random() : static_cast<unsigned>(smooth) + random() % 3);
      if (sample.color == PNG_COLOR_TYPE_PALETTE) rows[y][x] = static_cast<std::uint8_t>(rows[y][x] % 16);
    }
  }
  return rows;
}

void describe(const PngSample& sample, png_structp png, png_infop info) {
  png_set_IHDR(png, info, static_cast<png_uint_32>(sample.width), static_cast<png_uint_32>(sample.height), sample.bits,
               sample.color, sample.interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_color palette[16];
  for (int i = 0; i < 16; ++i) palette[i] = {png_byte(10 * i), png_byte(15 * i), png_byte(255 - 7 * i)};
  if (sample.color == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 16);
  png_color_16 transparent{1, 120, 130, 140, 128};
  if (sample.transparent) png_set_tRNS(png, info, nullptr, 0, &transparent);
  char key[] = "Comment", text[] = "a car";
  png_text comment{};
  comment.compression = PNG_TEXT_COMPRESSION_NONE;
  comment.key = key;
  comment.text = text;
  if (sample.text) png_set_text(png, info, &comment, 1);
}

}  // namespace

std::string PngSample::write() const {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &file, append, nullptr);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, filters);
  png_set_compression_level(png, level);
  png_set_compression_buffer_size(png, static_cast<std::size_t>(idat_bytes));
  describe(*this, png, info);
  png_write_info(png, info);
  auto rows = rowsOf(*this, png_get_rowbytes(png, info));
  std::vector<png_bytep> starts;
  for (auto& row : rows) starts.push_back(row.data());
  png_write_image(png, starts.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return text ? pngOf([&] {
    auto chunks = pngChunksOf(file);
    chunks.insert(chunks.end() - 1, pngChunk("tEXtbehind" + std::string(1, '\0') + "a van"));
    return chunks;
  }())
              : file;
}

std::string pngChunk(const std::string& name_and_data) {
  const auto crc = crc32(0, bytesOf(name_and_data), static_cast<uInt>(name_and_data.size()));
  return bigEndian(static_cast<std::uint32_t>(name_and_data.size() - 4)) + name_and_data +
         bigEndian(static_cast<std::uint32_t>(crc));
}

std::vector<std::string> pngChunksOf(std::string_view file) {
  std::vector<std::string> chunks;
  for (std::size_t at = kSignature_bytes; at < file.size(); at += chunks.back().size()) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<std::uint8_t>(file[at + i]);
    chunks.emplace_back(file.substr(at, 12 + length));
  }
  return chunks;
}

std::string pngOf(const std::vector<std::string>& chunks) {
  std::string file = signature();
  for (const std::string& chunk : chunks) file += chunk;
  return file;
}

std::string unpackedIdat(std::string_view file) {
  std::string bytes(1 << 20, '\0');
  uLongf length = bytes.size();
  for (const std::string& chunk : pngChunksOf(file))
    if (chunk.substr(4, 4) == "IDAT")
      uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length, bytesOf(chunk) + 8, chunk.size() - 12);
  bytes.resize(length);
  return bytes;
}

std::string withIdat(std::string_view file, const std::string& data) {
  auto chunks = pngChunksOf(file);
  for (std::string& chunk : chunks)
    if (chunk.substr(4, 4) == "IDAT") chunk = pngChunk("IDAT" + data);
  return pngOf(chunks);
}

std::string Deflate::operator()(std::string_view bytes) const {
  z_stream stream{};
  deflateInit2(&stream, level, Z_DEFLATED, window_bits, 8, strategy);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = const_cast<Bytef*>(bytesOf(bytes));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace motorcade::test
