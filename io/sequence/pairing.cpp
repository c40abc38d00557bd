#include "io/sequence/pairing.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostImagesNamed = 3;

std::vector<std::int64_t> numbersOf(const ImagesByNumber& images) {
  std::vector<std::int64_t> numbers;
  for (const auto& [number, image] : images) numbers.push_back(number);
  return numbers;
}

/// The median difference of numbers that follow each other; 0 where there are none.
std::int64_t middleStep(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < numbers.size(); ++i) steps.push_back(numbers[i] - numbers[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

/// The largest difference between the numbers of a pair: less than half of the shorter step.
std::int64_t mostApart(const KeyedImages& keyed) {
  if (keyed.kind == NameKind::kNames) return 0;
  const std::int64_t left = middleStep(numbersOf(keyed.left)), right = middleStep(numbersOf(keyed.right));
  const std::int64_t step = left > 0 && right > 0 ? std::min(left, right) : std::max(left, right);
  return std::max<std::int64_t>(0, (step - 1) / 2);
}

std::int64_t pairsIn(const PairedImages& paired) { return std::ranges::count_if(paired.frames, &FramePaths::isPair); }

/// Walks through both sides at once.
class Zipper {
 public:
  Zipper(const KeyedImages& keyed, const NamedImages& left, const NamedImages& right)
      : keyed_(keyed), left_(left), right_(right), most_apart_(mostApart(keyed)) {}

  PairedImages zip() {
    paired_.kind = keyed_.kind;
    for (auto l = keyed_.left.begin(), r = keyed_.right.begin(); l != keyed_.left.end() || r != keyed_.right.end();) {
      if (r == keyed_.right.end() || (l != keyed_.left.end() && isAlone(l, r, keyed_.left, keyed_.right)))
        add(l->first, {.left = l->second, .right = expectedImage(right_, left_, l->second), .right_missing = true}),
            ++l;
      else if (l == keyed_.left.end() || isAlone(r, l, keyed_.right, keyed_.left))
        add(r->first, {.left = expectedImage(left_, right_, r->second), .right = r->second, .left_missing = true}), ++r;
      else
        addPair(l++, r++);
    }
    tellApart();
    return std::move(paired_);
  }

 private:
  using Place = ImagesByNumber::const_iterator;

  /// Returns whether an image has no partner among the images of the other side that are not yet paired. `other` is the
  /// first of these.
  bool isAlone(Place image, Place other, const ImagesByNumber& own_side, const ImagesByNumber& other_side) const {
    if (other == other_side.end()) return true;
    if (other->first - image->first > most_apart_) return true;
    if (image->first >= other->first) return false;
    const Place next = std::next(image);  // it may be the nearer one
    return next != own_side.end() && std::abs(next->first - other->first) < other->first - image->first;
  }
  void addPair(Place left, Place right) {
    apart_.push_back(std::abs(left->first - right->first));
    add(left->first, {.left = left->second, .right = right->second});
  }
  /// Adds a note if the two images of pairs were not taken together. Times of cameras that are triggered together
  /// differ by less than five milliseconds.
  void tellApart() {
    constexpr std::int64_t kTogether_ns = 5'000'000;
    const auto middle = apart_.begin() + std::ssize(apart_) / 2;
    std::ranges::nth_element(apart_, middle);
    if (paired_.kind != NameKind::kTimes || apart_.empty() || *middle < kTogether_ns) return;
    paired_.notes.push_back("the two images of a pair are taken " + std::to_string(*middle / 1'000'000) +
                            " ms apart by the times in their names: distances of what moves are wrong");
  }
  void add(std::int64_t number, FramePaths frame) {
    paired_.numbers.push_back(number);
    paired_.frames.push_back(std::move(frame));
  }

  const KeyedImages& keyed_;
  const NamedImages &left_, &right_;
  std::int64_t most_apart_;
  PairedImages paired_;
  std::vector<std::int64_t> apart_;  // of the pairs
};

void keepOnly(PairedImages& paired, const std::vector<bool>& kept) {
  PairedImages rest{.kind = paired.kind, .left_out = paired.left_out, .notes = std::move(paired.notes)};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i]) {
      rest.frames.push_back(std::move(paired.frames[i]));
      rest.numbers.push_back(paired.numbers[i]);
    } else {
      ++rest.left_out;
    }
  }
  paired = std::move(rest);
}

/// Leaves out the images between the pairs where one side has several images for each of the other.
void leaveOutSurplus(PairedImages& paired) {
  constexpr double kOnGrid = 0.25;            // of the pairs' step
  constexpr std::ptrdiff_t kFewestPairs = 5;  // that tell a step
  std::vector<std::int64_t> of_pairs;
  for (std::size_t i = 0; i < paired.frames.size(); ++i)
    if (paired.frames[i].isPair()) of_pairs.push_back(paired.numbers[i]);
  const std::int64_t step = middleStep(of_pairs);
  if (paired.kind == NameKind::kNames || std::ssize(of_pairs) < kFewestPairs ||
      2 * step < 3 * middleStep(paired.numbers))
    return;
  const auto isSurplus = [&](std::size_t i) {
    const double place = static_cast<double>(paired.numbers[i] - of_pairs.front()) / static_cast<double>(step);
    return !paired.frames[i].isPair() && std::abs(place - std::round(place)) > kOnGrid;
  };
  std::vector<bool> kept;
  for (std::size_t i = 0; i < paired.frames.size(); ++i) kept.push_back(!isSurplus(i));
  const std::int64_t before = paired.left_out;
  keepOnly(paired, kept);
  if (paired.left_out > before)
    paired.notes.push_back("one camera has several images for each of the other: " +
                           std::to_string(paired.left_out - before) + " between the pairs are left out");
}

void requireMostlyPairs(const PairedImages& paired) {
  const std::int64_t pairs = pairsIn(paired);
  if (2 * pairs >= std::ssize(paired.frames)) return;
  std::vector<fs::path> alone;
  for (const FramePaths& frame : paired.frames)
    if (!frame.isPair()) alone.push_back(frame.left_missing ? frame.right : frame.left);
  throw InputError(alone.front().parent_path().parent_path().string() + ": of " + std::to_string(paired.frames.size()) +
                   " numbers or times in the images' names only " + std::to_string(pairs) +
                   " have a left and a right image; without partner are " + namesOf(alone) +
                   ". Give the images of a pair the same number, or list them: LEFT RIGHT in each line of a text file");
}

void tellStrays(PairedImages& paired, const NamedImages& left, const NamedImages& right) {
  std::vector<fs::path> strays = left.strays;
  strays.insert(strays.end(), right.strays.begin(), right.strays.end());
  if (strays.empty()) return;
  paired.left_out += std::ssize(strays);
  paired.notes.push_back("names of another kind than the others are left out: " + namesOf(strays));
}

/// Pairs the images in order, as nothing else tells which belong together.
PairedImages pairInOrder(const NamedImages& left, const NamedImages& right) {
  const fs::path left_folder = left.images.front().parent_path(), right_folder = right.images.front().parent_path();
  if (left.images.size() != right.images.size())
    throw InputError(left_folder.string() + " holds " + std::to_string(left.images.size()) + " images, " +
                     right_folder.string() + " holds " + std::to_string(right.images.size()) + ", and their names (" +
                     left.images.front().filename().string() + ", " + right.images.front().filename().string() +
                     ") do not tell which belong together; give the images of a pair the same number, or list them: "
                     "LEFT RIGHT in each line of a text file");
  PairedImages paired;
  for (std::size_t i = 0; i < left.images.size(); ++i) {
    paired.frames.push_back({.left = left.images[i], .right = right.images[i]});
    paired.numbers.push_back(static_cast<std::int64_t>(i));
  }
  paired.notes.push_back("the names do not tell which images belong together: they are paired in order, " +
                         namesOf({left.images.front()}) + " with " + namesOf({right.images.front()}) + " to " +
                         namesOf({left.images.back()}) + " with " + namesOf({right.images.back()}));
  return paired;
}

/// Returns whether any image has a partner; where none has, the names tell nothing about pairs.
bool anyPair(const PairedImages& paired) { return std::ranges::any_of(paired.frames, &FramePaths::isPair); }

}  // namespace

std::string namesOf(const std::vector<fs::path>& images) {
  std::string text;
  for (std::size_t i = 0; i < std::min(images.size(), kMostImagesNamed); ++i)
    text += (i > 0 ? ", " : "") + (images[i].parent_path().filename() / images[i].filename()).string();
  if (images.size() > kMostImagesNamed) text += " and " + std::to_string(images.size() - kMostImagesNamed) + " more";
  return text;
}

PairedImages pairByKeys(const KeyedImages& keyed, const NamedImages& left, const NamedImages& right) {
  PairedImages paired = Zipper(keyed, left, right).zip();
  leaveOutSurplus(paired);
  requireMostlyPairs(paired);
  return paired;
}

PairedImages pairImages(const NamedImages& left, const NamedImages& right) {
  const KeyedImages keyed = keyedImages(left, right);
  PairedImages paired =
      anyPair(Zipper(keyed, left, right).zip()) ? pairByKeys(keyed, left, right) : pairInOrder(left, right);
  tellStrays(paired, left, right);
  return paired;
}

void leaveOutEnds(PairedImages& paired) {
  const auto first = std::ranges::find_if(paired.frames, &FramePaths::isPair);
  const auto last = std::find_if(paired.frames.rbegin(), paired.frames.rend(), std::mem_fn(&FramePaths::isPair)).base();
  std::vector<bool> kept(paired.frames.size(), false);
  std::fill(kept.begin() + (first - paired.frames.begin()), kept.begin() + (last - paired.frames.begin()), true);
  const std::int64_t before = paired.left_out;
  keepOnly(paired, kept);
  if (paired.left_out > before)
    paired.notes.push_back(std::to_string(paired.left_out - before) +
                           " single images before the first pair or after the last are left out");
}

void tellMissing(PairedImages& paired) {
  std::vector<fs::path> left, right, both;
  for (const FramePaths& frame : paired.frames) {
    if (frame.left_missing && frame.right_missing)
      both.push_back(frame.left);
    else if (frame.left_missing)
      left.push_back(frame.left);
    else if (frame.right_missing)
      right.push_back(frame.right);
  }
  if (left.empty() && right.empty() && both.empty()) return;
  std::string text;
  const auto tell = [&](const std::string& sentence) { text += (text.empty() ? "" : ", ") + sentence; };
  if (!left.empty()) tell(std::to_string(left.size()) + " left missing (" + namesOf(left) + ")");
  if (!right.empty()) tell(std::to_string(right.size()) + " right missing (" + namesOf(right) + ")");
  if (!both.empty()) tell(std::to_string(both.size()) + " missing on both sides (" + namesOf(both) + ")");
  paired.notes.push_back("images are missing: " + text + "; " + std::to_string(pairsIn(paired)) + " of " +
                         std::to_string(paired.frames.size()) +
                         " frames are pairs, the others have no images and a predicted pose");
}

std::int64_t usualStep(const std::vector<std::int64_t>& numbers) {
  std::map<std::int64_t, int> counts;
  for (std::size_t i = 1; i < numbers.size(); ++i) ++counts[numbers[i] - numbers[i - 1]];
  if (counts.empty()) return 1;
  return std::ranges::max_element(counts, {}, [](const auto& step_and_count) { return step_and_count.second; })->first;
}

}  // namespace motorcade
