#pragma once

#include <cstdint>

/// Limits of this process, as a small machine or a full disk would set them. They cannot be taken back.
namespace motorcade {

/// The address space may grow by so much and no more.
void limitFurtherMemory(std::uint64_t bytes);
/// No file may grow beyond this size: a write fails as on a full disk.
void limitFileSize(std::uint64_t bytes);

}  // namespace motorcade
