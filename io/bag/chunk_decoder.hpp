#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace motorcade::mcap {

/// A buffer that keeps its capacity. Its bytes are not initialized.
class ByteBuffer {
 public:
  std::span<std::uint8_t> ofSize(std::size_t size);

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::size_t room_ = 0;
};

/// Larger records and chunks are refused: a few bytes may claim more than the memory.
inline constexpr std::size_t kMostRecord_bytes = std::size_t{256} << 20;

/// The records of a chunk: `size` bytes once uncompressed. The compression is named `zstd`, `lz4`, or empty for none.
/// The result points into `compressed` or `buffer`. Throws InputError that begins with `place`.
std::span<const std::uint8_t> chunkRecords(std::string_view compression, std::span<const std::uint8_t> compressed,
                                           std::uint64_t size, ByteBuffer& buffer, const std::string& place);

}  // namespace motorcade::mcap
