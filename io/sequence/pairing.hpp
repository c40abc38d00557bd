#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/sequence/image_names.hpp"
#include "io/sequence/sequence.hpp"

/// Pairs the images of two sides.
namespace motorcade {

struct PairedImages {
  NameKind kind = NameKind::kNames;
  std::vector<FramePaths> frames{};
  std::vector<std::int64_t> numbers{};  // of the frames, increasing; see NameKind
  std::int64_t left_out = 0;            // images that belong to no frame
  std::vector<std::string> notes{};     // that the user should read
};

/// Pairs images whose numbers or times are the same, or differ by less than half of the usual step. A single image is a
/// frame whose other image is missing; where one side has several images for each of the other, those between the pairs
/// are left out. Throws InputError where fewer than half of the frames would be pairs.
PairedImages pairByKeys(const KeyedImages& keyed, const NamedImages& left, const NamedImages& right);

/// Pairs images by what their names tell, and in order only where they tell nothing and both sides have as many.
PairedImages pairImages(const NamedImages& left, const NamedImages& right);

/// Leaves out single images before the first pair and after the last.
void leaveOutEnds(PairedImages& paired);

/// Says which images are missing; nothing where none is.
void tellMissing(PairedImages& paired);

/// The names of up to three of them, with their folders, and the number of the others.
std::string namesOf(const std::vector<std::filesystem::path>& images);

/// The most frequent difference of numbers that follow each other; 1 where there are none.
std::int64_t usualStep(const std::vector<std::int64_t>& numbers);

/// Puts pairs into a sequence, in the order of their numbers. Where most numbers have one step, a number that both
/// sides lack becomes a frame without images, up to a hundred in a row. Longer gaps only take time. Times become the
/// frames' stamps.
void setPairs(Sequence& sequence, PairedImages paired);

/// Removes the frames that both sides lack, when times that do not come from the numbers show that nothing is missing.
void closeNumbers(Sequence& sequence);

}  // namespace motorcade
