#include "backend/block_pool.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <new>

namespace motorcade {
namespace {

constexpr std::size_t kUnit = 8;              // doubles in a cache line
constexpr std::size_t kChunk = std::size_t{1} << 16;  // doubles
constexpr std::align_val_t kAlignment{64};

/// Sizes in cache lines: 1 to 8, then four steps to each doubling, so that at most a fifth of a block is spare.
struct SizeClass {
  int index;
  std::size_t doubles;
  explicit SizeClass(std::size_t wanted) {
    const std::uint64_t units = std::max<std::uint64_t>((wanted + kUnit - 1) / kUnit, 1);
    if (units <= 8) {
      index = static_cast<int>(units) - 1;
      doubles = units * kUnit;
      return;
    }
    const int octave = std::bit_width(units - 1) - 1;  // 2^octave < units <= 2^(octave + 1)
    const std::uint64_t step = std::uint64_t{1} << (octave - 2);
    const std::uint64_t quarter = (units - 1 - (std::uint64_t{1} << octave)) / step;
    index = 8 + (octave - 3) * 4 + static_cast<int>(quarter);
    doubles = ((std::uint64_t{1} << octave) + (quarter + 1) * step) * kUnit;
  }
};

}  // namespace

void BlockPool::Release::operator()(double* chunk) const { ::operator delete(chunk, kAlignment); }

double* BlockPool::take(std::size_t doubles) {
  const SizeClass size(doubles);
  used_bytes_ += size.doubles * sizeof(double);
  auto& free = free_[static_cast<std::size_t>(size.index)];
  if (free.empty()) return cut(size.doubles);
  double* block = free.back();
  free.pop_back();
  return block;
}

void BlockPool::give(double* block, std::size_t doubles) {
  if (!block) return;
  const SizeClass size(doubles);
  used_bytes_ -= size.doubles * sizeof(double);
  free_[static_cast<std::size_t>(size.index)].push_back(block);
}

double* BlockPool::cut(std::size_t doubles) {
  if (doubles > left_) {
    const std::size_t length = std::max(doubles, kChunk);
    chunks_.emplace_back(static_cast<double*>(::operator new(length * sizeof(double), kAlignment)));
    held_bytes_ += length * sizeof(double);
    if (length > kChunk) return chunks_.back().get();
    next_ = chunks_.back().get();
    left_ = length;
  }
  double* block = next_;
  next_ += doubles;
  left_ -= doubles;
  return block;
}

}  // namespace motorcade
