#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/pipeline/admission.hpp"

namespace motorcade {

/// Reason why a pair was not taken; static text. Empty where the reason is not the pair's.
const char* reasonOf(Admission admission);

/// Notices stamps that seem to have another unit: several pairs in a row are too close together, or far apart. Used by
/// the pushing thread only.
class StampDoubts {
 public:
  /// A sentence about a pair that was not taken, once.
  std::optional<std::string> refused(Admission admission, std::int64_t stamp_ns);
  void taken();

 private:
  int untimely_ = 0;
  bool told_ = false;
};

}  // namespace motorcade
