#include "core/image.hpp"

#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace motorcade {
namespace {

constexpr std::size_t kAlignment = 32;
constexpr int kTail_bytes = 32;

struct AlignedDelete {
  void operator()(std::uint8_t* p) const { ::operator delete[](p, std::align_val_t{kAlignment}); }
};
using Buffer = std::unique_ptr<std::uint8_t[], AlignedDelete>;

Buffer makeBuffer(std::size_t bytes) { return Buffer(static_cast<std::uint8_t*>(::operator new[](bytes, std::align_val_t{kAlignment}))); }

}  // namespace

Image::Image(std::shared_ptr<std::uint8_t[]> buffer, int width, int height, int stride)
    : buffer_(std::move(buffer)), width_(width), height_(height), stride_(stride) {}

/// Idle buffers by size. Outlives the pool while images are still in use.
struct ImagePool::Shelf {
  struct Idle {
    std::size_t bytes;
    Buffer buffer;
  };
  std::mutex mutex;
  std::vector<Idle> idle;
  std::size_t made = 0;

  Buffer take(std::size_t bytes) {
    const std::scoped_lock lock(mutex);
    for (auto& entry : idle) {
      if (entry.bytes != bytes) continue;
      Buffer buffer = std::move(entry.buffer);
      std::swap(entry, idle.back());
      idle.pop_back();
      return buffer;
    }
    ++made;
    return makeBuffer(bytes);
  }

  void putBack(std::size_t bytes, Buffer buffer) {
    const std::scoped_lock lock(mutex);
    idle.push_back({bytes, std::move(buffer)});
  }
};

ImagePool::ImagePool() : shelf_(std::make_shared<Shelf>()) {}

Image ImagePool::acquire(int width, int height) {
  const int stride = (width + 31) / 32 * 32;
  const auto bytes = static_cast<std::size_t>(stride) * static_cast<std::size_t>(height) + kTail_bytes;
  auto give_back = [shelf = shelf_, bytes](std::uint8_t* p) { shelf->putBack(bytes, Buffer(p)); };
  return {std::shared_ptr<std::uint8_t[]>(shelf_->take(bytes).release(), std::move(give_back)), width, height, stride};
}

std::size_t ImagePool::buffersMade() const {
  const std::scoped_lock lock(shelf_->mutex);
  return shelf_->made;
}

}  // namespace motorcade
