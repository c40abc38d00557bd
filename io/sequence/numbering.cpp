#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "io/sequence/pairing.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostFilled = 100;  // frames in a row, ten seconds of a usual camera

/// The pattern that the numbers in image names follow.
struct Steps {
  std::int64_t step = 1;
  bool even = false;      // most differences are one step
  bool counting = false;  // numbers tell how many images lie between two others
};

Steps stepsOf(const std::vector<std::int64_t>& numbers) {
  constexpr std::int64_t kMostBetween = 20;  // images, of an uneven numbering: more are ticks of a clock
  if (numbers.size() < 2) return {.even = true, .counting = true};
  const std::int64_t usual = usualStep(numbers);
  std::int64_t common = 0;
  std::ptrdiff_t usual_count = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const std::int64_t difference = numbers[i] - numbers[i - 1];
    common = std::gcd(common, difference);
    if (difference == usual) ++usual_count;
  }
  Steps steps{.step = std::max<std::int64_t>(common, 1),
              .even = usual == common && 2 * usual_count >= std::ssize(numbers) - 1};
  const std::int64_t mean = (numbers.back() - numbers.front()) / (std::ssize(numbers) - 1);
  steps.counting = steps.even || mean <= kMostBetween * common;
  return steps;
}

/// The name of an image with another number. The number is the last of the digits that have its value.
fs::path renumbered(const fs::path& image, std::int64_t from, std::int64_t to) {
  NameParts parts = partsOfName(image.stem().string());
  std::size_t part = parts.size() - 1 - parts.size() % 2;
  while (part > 1 && std::strtoll(parts[part].c_str(), nullptr, 10) != from) part -= 2;
  const std::string digits = std::to_string(to);
  const std::size_t width = parts[part].size();
  parts[part] = digits.size() < width ? std::string(width - digits.size(), '0') + digits : digits;
  std::string name;
  for (const std::string& text : parts) name += text;
  return image.parent_path() / (name + image.extension().string());
}

/// Adds the frames that both sides lack.
void fillHoles(PairedImages& paired, std::int64_t step) {
  PairedImages filled{.kind = paired.kind, .left_out = paired.left_out, .notes = std::move(paired.notes)};
  FramePaths like;  // the frame before
  for (std::size_t i = 0; i < paired.frames.size(); ++i) {
    if (i > 0 && paired.numbers[i] - paired.numbers[i - 1] <= (kMostFilled + 1) * step)
      for (std::int64_t number = paired.numbers[i - 1] + step; number < paired.numbers[i]; number += step) {
        filled.frames.push_back({.left = renumbered(like.left, paired.numbers[i - 1], number),
                                 .right = renumbered(like.right, paired.numbers[i - 1], number),
                                 .left_missing = true,
                                 .right_missing = true});
        filled.numbers.push_back(number);
      }
    like = paired.frames[i];
    filled.frames.push_back(std::move(paired.frames[i]));
    filled.numbers.push_back(paired.numbers[i]);
  }
  paired = std::move(filled);
}

/// The place of each frame in the complete numbering; empty where the numbering has no holes.
std::vector<std::int64_t> placesOf(const std::vector<std::int64_t>& numbers, std::int64_t step) {
  std::vector<std::int64_t> places;
  for (const std::int64_t number : numbers) places.push_back((number - numbers.front()) / step);
  const bool closed = places.empty() || places.back() + 1 == std::ssize(places);
  return closed ? std::vector<std::int64_t>{} : places;
}

void tellUneven(PairedImages& paired, const Steps& steps) {
  if (!steps.counting)
    paired.notes.emplace_back(
        "the numbers in the names go on unevenly, and tell no times: frames are taken as evenly spaced");
  else if (!steps.even)
    paired.notes.emplace_back("the numbers in the names go on unevenly: frames are taken as far apart as they tell");
}

void setNumbers(Sequence& sequence, PairedImages& paired) {
  const Steps steps = stepsOf(paired.numbers);
  if (steps.even) fillHoles(paired, steps.step);
  tellUneven(paired, steps);
  if (!steps.counting || paired.numbers.empty()) return;
  sequence.numbering = {
      .first = paired.numbers.front(), .step = steps.step, .places = placesOf(paired.numbers, steps.step)};
}

}  // namespace

void setPairs(Sequence& sequence, PairedImages paired) {
  if (paired.kind == NameKind::kNumbers) setNumbers(sequence, paired);
  if (paired.kind == NameKind::kTimes) leaveOutEnds(paired);
  tellMissing(paired);
  sequence.left_out = paired.left_out;
  for (const std::string& note : paired.notes) sequence.notes.push_back({"pairs", note});
  sequence.frames = std::move(paired.frames);
  if (paired.kind != NameKind::kTimes) return;
  for (const std::int64_t number : paired.numbers) sequence.stamps.push_back({number});
  sequence.stamps_measured = true;
}

void closeNumbers(Sequence& sequence) {
  std::erase_if(sequence.frames, [](const FramePaths& frame) { return frame.left_missing && frame.right_missing; });
  sequence.numbering.places.clear();
}

}  // namespace motorcade
