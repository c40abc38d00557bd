#include "core/image.hpp"

#include <array>
#include <atomic>
#include <new>
#include <utility>

#include "core/object_pool.hpp"

namespace motorcade {
namespace {

constexpr std::align_val_t kAlignment{64};
constexpr std::size_t kHeader_bytes = 128;  // before the pixels: for the shared pointer's counts
constexpr std::size_t kTail_bytes = 32;     // readable after the last row
constexpr int kRowAlignment_bytes = 32;     // of a vector of AVX
constexpr std::size_t kSizes = 16;          // distinct sizes whose buffers are kept; others go back to the heap

}  // namespace

Image::Image(std::shared_ptr<std::uint8_t[]> buffer, int width, int height, int stride)
    : buffer_(std::move(buffer)), width_(width), height_(height), stride_(stride) {}

/// Idle buffers by size. Outlives the pool while images are still in use.
class ImagePool::Shelf {
 public:
  Shelf() = default;
  Shelf(const Shelf&) = delete;
  Shelf& operator=(const Shelf&) = delete;
  ~Shelf() {
    for (Row& row : rows_)
      while (std::byte* buffer = row.idle.take()) release(buffer);
  }

  std::byte* take(std::size_t bytes) {
    Row* row = rowOf(bytes);
    if (std::byte* buffer = row ? row->idle.take() : nullptr) return buffer;
    made_.fetch_add(1, std::memory_order_relaxed);
    auto* buffer = static_cast<std::byte*>(::operator new(bytes, kAlignment));
    populatePages(buffer, bytes);
    return buffer;
  }

  void putBack(std::size_t bytes, std::byte* buffer) {
    Row* row = rowOf(bytes);
    if (!row || !row->idle.putBack(buffer)) release(buffer);
  }

  std::size_t made() const { return made_.load(std::memory_order_relaxed); }

 private:
  struct Row {
    std::atomic<std::size_t> bytes{0};  // size of its buffers; 0 while the row is unused
    IdleSlots<std::byte> idle;          // buffers beyond its slots go back to the heap
  };

  Row* rowOf(std::size_t bytes) {
    for (Row& row : rows_) {
      std::size_t held = row.bytes.load(std::memory_order_relaxed);
      if (held == bytes || (held == 0 && row.bytes.compare_exchange_strong(held, bytes, std::memory_order_relaxed)) ||
          held == bytes)
        return &row;
    }
    return nullptr;
  }
  static void release(std::byte* buffer) { ::operator delete(buffer, kAlignment); }

  std::array<Row, kSizes> rows_;
  std::atomic<std::size_t> made_{0};
};

/// Lays the counts of a shared pointer into the header of the buffer that it shares. The buffer is idle when they are
/// released, which comes last.
template <class T>
struct ImagePool::InHeader {
  using value_type = T;
  std::shared_ptr<Shelf> shelf;
  std::byte* buffer;
  std::size_t bytes;

  InHeader(std::shared_ptr<Shelf> s, std::byte* b, std::size_t n) : shelf(std::move(s)), buffer(b), bytes(n) {}
  template <class Other>
  explicit(false) InHeader(const InHeader<Other>& other)
      : shelf(other.shelf), buffer(other.buffer), bytes(other.bytes) {}

  T* allocate(std::size_t) const {
    static_assert(sizeof(T) <= kHeader_bytes && alignof(T) <= static_cast<std::size_t>(kAlignment));
    return reinterpret_cast<T*>(buffer);
  }
  void deallocate(T*, std::size_t) const { shelf->putBack(bytes, buffer); }
  template <class Other>
  bool operator==(const InHeader<Other>& other) const {
    return buffer == other.buffer;
  }
};

ImagePool::ImagePool() : shelf_(std::make_shared<Shelf>()) {}

Image ImagePool::acquire(int width, int height) {
  const int stride = (width + kRowAlignment_bytes - 1) / kRowAlignment_bytes * kRowAlignment_bytes;
  const auto bytes = kHeader_bytes + static_cast<std::size_t>(stride) * static_cast<std::size_t>(height) + kTail_bytes;
  std::byte* buffer = shelf_->take(bytes);
  const auto keep = [](std::uint8_t*) {};
  auto* pixels = reinterpret_cast<std::uint8_t*>(buffer + kHeader_bytes);
  return {std::shared_ptr<std::uint8_t[]>(pixels, keep, InHeader<std::uint8_t>(shelf_, buffer, bytes)), width, height,
          stride};
}

std::size_t ImagePool::buffersMade() const { return shelf_->made(); }

}  // namespace motorcade
