#pragma once

#include <cstdint>

/// Limits of this process, like those of a small machine or a full disk. They cannot be taken back.
namespace motorcade {

/// Lets the address space grow by `bytes` and no more.
void limitFurtherMemory(std::uint64_t bytes);
/// Lets no file grow beyond this size: a write fails as on a full disk.
void limitFileSize(std::uint64_t bytes);

}  // namespace motorcade
