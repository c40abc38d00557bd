#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace motorcade {

/// Memory for small matrices that come and go, cut from large chunks. Returned neighbors become one block again, so the
/// pool grows with the largest demand so far, not with the largest of each size. Below that demand it hardly ever asks
/// the heap. Blocks begin on a cache line.
class BlockPool {
 public:
  /// Takes at least `doubles` numbers, uninitialized.
  double* take(std::size_t doubles);
  /// True when a block that is out has room for so many numbers.
  static bool fits(const double* block, std::size_t doubles);
  /// Takes an eighth more than asked for, so that a block that grows little by little seldom moves and leaves few
  /// holes.
  double* takeToGrow(std::size_t doubles) { return take(doubles + doubles / 8); }
  /// Returns a block to the pool; null is ignored.
  void give(double* block);

  std::size_t heldBytes() const { return held_bytes_; }  // of all chunks
  std::size_t usedBytes() const { return used_bytes_; }  // of the blocks that are out

 private:
  struct Release {
    void operator()(std::byte* chunk) const;
  };
  using Chunk = std::unique_ptr<std::byte[], Release>;
  struct Tag;   // before each block
  struct Idle;  // in a block that is in the pool

  Idle* fitting(std::uint32_t lines);
  Idle* addChunk(std::uint32_t lines);
  void insert(Idle* block, std::uint32_t lines);
  void remove(Idle* block);

  static constexpr int kClasses = 128;
  std::array<Idle*, kClasses> idle_{};              // by size, each a list
  std::array<std::uint64_t, kClasses / 64> any_{};  // a bit for each list that is not empty
  std::vector<Chunk> chunks_;
  std::size_t held_bytes_ = 0, used_bytes_ = 0;
};

}  // namespace motorcade
