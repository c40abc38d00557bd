#include "io/bag/chunk_decoder.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade::mcap {
namespace {

struct Lz4Context {
  Lz4Context() {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  }
  ~Lz4Context() { LZ4F_freeDecompressionContext(context); }
  Lz4Context(const Lz4Context&) = delete;
  Lz4Context& operator=(const Lz4Context&) = delete;

  LZ4F_dctx* context = nullptr;
};

/// True where the frame fills the whole output and ends with it.
bool unpackLz4(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  const Lz4Context lz4;
  std::size_t hint = 1;
  while (hint != 0) {
    std::size_t read = in.size(), written = out.size();
    hint = LZ4F_decompress(lz4.context, out.data(), &written, in.data(), &read, nullptr);
    if (LZ4F_isError(hint) != 0 || (read == 0 && written == 0)) return false;
    in = in.subspan(read);
    out = out.subspan(written);
  }
  return out.empty();
}

bool unpackZstd(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  return ZSTD_decompress(out.data(), out.size(), in.data(), in.size()) == out.size();
}

}  // namespace

std::span<std::uint8_t> ByteBuffer::ofSize(std::size_t size) {
  if (size > room_) {
    bytes_ = std::make_unique_for_overwrite<std::uint8_t[]>(size);
    room_ = size;
  }
  return {bytes_.get(), size};
}

std::span<const std::uint8_t> chunkRecords(std::string_view compression, std::span<const std::uint8_t> compressed,
                                           std::uint64_t size, ByteBuffer& buffer, const std::string& place) {
  if (compression.empty()) return compressed;
  if (compression != "zstd" && compression != "lz4")
    throw InputError(place + ": the chunk's compression '" + printable(compression) +
                     "' is not read; write the file anew with zstd, lz4 or none");
  if (size > kMostRecord_bytes)
    throw InputError(place + ": the chunk has " + std::to_string(size) + " bytes when it is unpacked, " +
                     std::to_string(kMostRecord_bytes) + " at most are read; write the file anew with smaller chunks");
  const auto records = buffer.ofSize(static_cast<std::size_t>(size));
  if (!(compression == "zstd" ? unpackZstd(compressed, records) : unpackLz4(compressed, records)))
    throw InputError(place + ": the chunk cannot be unpacked: the file is damaged");
  return records;
}

}  // namespace motorcade::mcap
