#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace motorcade {

/// A set of small numbers, such as ids or cliques, which is emptied in constant time and keeps its memory.
class MarkSet {
 public:
  /// Empties the set, and makes room for numbers below `end`, which must not shrink.
  void reset(std::size_t end) {
    round_of_.resize(end, 0);
    ++round_;
  }
  bool contains(std::size_t number) const { return round_of_[number] == round_; }
  /// Adds a number; false when it is in the set already.
  bool insert(std::size_t number) {
    if (contains(number)) return false;
    round_of_[number] = round_;
    return true;
  }

 private:
  std::vector<std::uint32_t> round_of_;  // per number: the round that inserted it last
  std::uint32_t round_ = 0;
};

}  // namespace motorcade
