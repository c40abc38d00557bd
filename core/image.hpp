#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace motorcade {

/// A gray 8-bit image: a strided view over a shared, usually pooled, buffer. Copying it shares the pixels.
/// Fill it through `mutableRow` before it is handed on; afterwards it is read only.
class Image {
 public:
  Image() = default;
  Image(std::shared_ptr<std::uint8_t[]> buffer, int width, int height, int stride);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Bytes from one row to the next; a multiple of 32.
  int stride() const { return stride_; }
  bool empty() const { return buffer_ == nullptr; }

  const std::uint8_t* data() const { return buffer_.get(); }
  const std::uint8_t* row(int y) const { return buffer_.get() + static_cast<std::ptrdiff_t>(y) * stride_; }
  std::uint8_t* mutableRow(int y) { return buffer_.get() + static_cast<std::ptrdiff_t>(y) * stride_; }
  std::uint8_t at(int x, int y) const { return row(y)[x]; }

 private:
  std::shared_ptr<std::uint8_t[]> buffer_;
  int width_ = 0, height_ = 0, stride_ = 0;
};

/// Brightness of a color, weighted as in BT.601.
constexpr std::uint8_t grayOf(int red, int green, int blue) {
  return static_cast<std::uint8_t>((77 * red + 150 * green + 29 * blue + 128) >> 8);
}

/// Hands out images and takes their buffers back when the last view is gone, so that a steady stream of frames touches
/// no fresh memory. Any thread may acquire and release images. Neither takes a lock nor, once the stream is warm, the
/// heap.
class ImagePool {
 public:
  ImagePool();
  /// An image with undefined content. Rows start at multiples of 32 bytes, with 32 readable bytes after the last row.
  Image acquire(int width, int height);
  /// Buffers made so far: constant once the stream is warm.
  std::size_t buffersMade() const;

 private:
  class Shelf;
  template <class T>
  struct InHeader;
  std::shared_ptr<Shelf> shelf_;
};

}  // namespace motorcade
