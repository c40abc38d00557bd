#include "backend/graph/block_pool.hpp"

#include <algorithm>
#include <bit>
#include <new>

#include "core/object_pool.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kLine_bytes = 64;
constexpr std::uint32_t kChunkLines = 1U << 14;  // a megabyte
constexpr std::align_val_t kAlignment{kLine_bytes};

/// Class of a size in cache lines: one each for 1 to 8, then four to each doubling.
std::size_t sizeClass(std::uint32_t lines) {
  if (lines <= 8) return lines - 1;
  const int octave = std::bit_width(lines - 1) - 1;  // 2^octave < lines <= 2^(octave + 1)
  const std::uint32_t quarter = (lines - 1 - (1U << octave)) >> (octave - 2);
  return 8 + static_cast<std::size_t>(octave - 3) * 4 + quarter;
}

}  // namespace

/// Tag of a block, in the 16 bytes before its first line, which are the last ones of the block below it. Behind a
/// chunk's last block lies the tag of an empty one that is never idle.
struct BlockPool::Tag {
  std::uint32_t lines = 0, lines_below = 0;  // of this block and of the one below it; 0: it is the first
  std::uint64_t idle = 0;
};

struct BlockPool::Idle {
  Idle *previous = nullptr, *next = nullptr;

  std::byte* begin() { return reinterpret_cast<std::byte*>(this); }
  Tag& tag() { return *std::launder(reinterpret_cast<Tag*>(begin() - sizeof(Tag))); }
  Idle* above() { return reinterpret_cast<Idle*>(begin() + tag().lines * kLine_bytes); }
  Idle* below() { return reinterpret_cast<Idle*>(begin() - tag().lines_below * kLine_bytes); }
  void setTag(std::uint32_t lines, std::uint32_t lines_below, bool idle) {
    new (begin() - sizeof(Tag)) Tag{lines, lines_below, idle};
  }
};

void BlockPool::Release::operator()(std::byte* chunk) const { ::operator delete(chunk, kAlignment); }

double* BlockPool::take(std::size_t doubles) {
  const auto lines =
      static_cast<std::uint32_t>((doubles * sizeof(double) + sizeof(Tag) + kLine_bytes - 1) / kLine_bytes);
  used_bytes_ += lines * kLine_bytes;
  Idle* block = fitting(lines);
  if (block)
    remove(block);
  else
    block = addChunk(lines);
  const Tag whole = block->tag();
  block->setTag(lines, whole.lines_below, false);
  if (whole.lines > lines) {
    Idle* rest = block->above();
    rest->setTag(whole.lines - lines, lines, true);
    rest->above()->tag().lines_below = whole.lines - lines;
    insert(rest, whole.lines - lines);
  }
  return reinterpret_cast<double*>(block);
}

bool BlockPool::fits(const double* data, std::size_t doubles) {
  const auto* const begin = reinterpret_cast<const std::byte*>(data);
  const Tag& tag = *std::launder(reinterpret_cast<const Tag*>(begin - sizeof(Tag)));
  return doubles * sizeof(double) <= tag.lines * kLine_bytes - sizeof(Tag);
}

void BlockPool::give(double* data) {
  if (!data) return;
  auto* block = reinterpret_cast<Idle*>(data);
  Tag whole = block->tag();
  used_bytes_ -= whole.lines * kLine_bytes;
  if (Idle* above = block->above(); above->tag().idle) {
    whole.lines += above->tag().lines;
    remove(above);
  }
  if (whole.lines_below > 0 && block->below()->tag().idle) {
    block = block->below();
    remove(block);
    whole.lines += block->tag().lines;
    whole.lines_below = block->tag().lines_below;
  }
  block->setTag(whole.lines, whole.lines_below, true);
  block->above()->tag().lines_below = whole.lines;
  insert(block, whole.lines);
}

/// Finds the smallest large enough among the first few blocks of the class, else the first of the next class that has
/// any; null when there is none.
BlockPool::Idle* BlockPool::fitting(std::uint32_t lines) {
  constexpr int kLooks = 16;
  const std::size_t first = sizeClass(lines);
  Idle* best = nullptr;
  int looks = 0;
  for (Idle* block = idle_[first]; block && looks < kLooks; block = block->next, ++looks)
    if (block->tag().lines >= lines && (!best || block->tag().lines < best->tag().lines)) best = block;
  if (best) return best;
  for (std::size_t c = first + 1; c < kClasses; c = (c / 64 + 1) * 64)
    if (const std::uint64_t any = any_[c / 64] >> c % 64; any != 0)
      return idle_[c + static_cast<std::size_t>(std::countr_zero(any))];
  return nullptr;
}

BlockPool::Idle* BlockPool::addChunk(std::uint32_t lines) {
  lines = std::max(lines, kChunkLines - 1);
  const std::size_t bytes = (lines + std::size_t{1}) * kLine_bytes;  // the first line is for the first block's tag
  chunks_.emplace_back(static_cast<std::byte*>(::operator new(bytes, kAlignment)));
  held_bytes_ += bytes;
  populatePages(chunks_.back().get(), bytes);
  auto* block = reinterpret_cast<Idle*>(chunks_.back().get() + kLine_bytes);
  block->setTag(lines, 0, false);
  block->above()->setTag(0, lines, false);
  return block;
}

void BlockPool::insert(Idle* block, std::uint32_t lines) {
  const std::size_t c = sizeClass(lines);
  new (block) Idle{.next = idle_[c]};
  if (idle_[c]) idle_[c]->previous = block;
  idle_[c] = block;
  any_[c / 64] |= std::uint64_t{1} << c % 64;
}

void BlockPool::remove(Idle* block) {
  const std::size_t c = sizeClass(block->tag().lines);
  (block->previous ? block->previous->next : idle_[c]) = block->next;
  if (block->next) block->next->previous = block->previous;
  if (!idle_[c]) any_[c / 64] &= ~(std::uint64_t{1} << c % 64);
}

}  // namespace motorcade
