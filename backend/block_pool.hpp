#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace motorcade {

/// Memory for small matrices that come and go: blocks of doubles cut from large chunks, sorted by size and given out again. It grows to the
/// largest demand so far and never asks the heap again below that. Blocks begin on a cache line.
class BlockPool {
 public:
  /// At least `doubles` numbers, uninitialised.
  double* take(std::size_t doubles);
  /// Returns a block; `doubles` as when it was taken.
  void give(double* block, std::size_t doubles);

  std::size_t heldBytes() const { return held_bytes_; }  // of all chunks
  std::size_t usedBytes() const { return used_bytes_; }  // of the blocks that are out

 private:
  struct Release {
    void operator()(double* chunk) const;
  };
  using Chunk = std::unique_ptr<double[], Release>;

  double* cut(std::size_t doubles);

  static constexpr int kClasses = 128;
  std::array<std::vector<double*>, kClasses> free_;
  std::vector<Chunk> chunks_;
  double* next_ = nullptr;
  std::size_t left_ = 0, held_bytes_ = 0, used_bytes_ = 0;
};

}  // namespace motorcade
