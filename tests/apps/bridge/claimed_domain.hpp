#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <unistd.h>

#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"

namespace motorcade::test {

/// A domain of DDS for one test: tests that run beside it have others. Its ports lie below those that the system
/// assigns.
class ClaimedDomain {
 public:
  ClaimedDomain() {
    for (int tried = 0; !lock_; ++tried) {
      if (tried == kCount) throw OutputError("all domains of DDS are in use");
      number_ = kFirst + (::getpid() + tried) % kCount;
      claim();
    }
  }
  int number() const { return number_; }

 private:
  static constexpr int kFirst = 60, kCount = 40;

  void claim() {
    const auto folder = std::filesystem::temp_directory_path() / ("motorcade_domain_" + std::to_string(number_));
    makeFolder(folder);
    try {
      lock_.emplace(folder);
    } catch (const OutputError&) {  // another test has it
    }
  }

  int number_ = 0;
  std::optional<FolderLock> lock_;
};

}  // namespace motorcade::test
