#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

/// Replaces the program's heap by itself with a look at each call: operator new and delete, and, by the linker's
/// --wrap, the C functions. For one file of a program that is a test of its own; that file defines what happens at each
/// call, and whether memory is given at all.
bool heapTaken();
void heapGiven();

/// Shows a block to what the compiler cannot see into. Without it clang leaves out a block that is taken and given back
/// with nothing of it read in between, so that there is no call to count.
inline void seeBlock(const void* block) { asm volatile("" : : "r"(block) : "memory"); }

// NOLINTBEGIN(misc-definitions-in-headers, *-reserved-identifier, readability-identifier-naming): the linker names them
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t number, std::size_t size);
void* __real_realloc(void* block, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);
int __real_posix_memalign(void** block, std::size_t alignment, std::size_t size);
void __real_free(void* block);

void* __wrap_malloc(std::size_t size) {
  if (!heapTaken()) return nullptr;
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t number, std::size_t size) {
  if (!heapTaken()) return nullptr;
  return __real_calloc(number, size);
}
void* __wrap_realloc(void* block, std::size_t size) {
  if (!heapTaken()) return nullptr;
  return __real_realloc(block, size);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  if (!heapTaken()) return nullptr;
  return __real_aligned_alloc(alignment, size);
}
int __wrap_posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  if (!heapTaken()) return ENOMEM;
  return __real_posix_memalign(block, alignment, size);
}
void __wrap_free(void* block) {
  if (block) heapGiven();
  __real_free(block);
}
}

// Where one of a pair is inlined and the other is not, compilers warn that they do not match.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* block = std::malloc(size)) return block;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto line = static_cast<std::size_t>(alignment);
  if (void* block = std::aligned_alloc(line, (size + line - 1) / line * line)) return block;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }
// NOLINTEND(misc-definitions-in-headers, *-reserved-identifier, readability-identifier-naming)
