#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "tests/frontend/image/pixel_lanes_test.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kPixels = 32;  // the bytes of a vector, and those that may be read after sixteen

std::array<std::uint8_t, kPixels> randomPixels(std::mt19937& random) {
  std::array<std::uint8_t, kPixels> pixels;
  for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(random());
  pixels[random() % kPixels] = 255, pixels[random() % kPixels] = 0;
  return pixels;
}
std::array<std::int16_t, kWordLanes> randomWords(std::mt19937& random) {
  std::array<std::int16_t, kWordLanes> words;
  for (std::int16_t& word : words) word = static_cast<std::int16_t>(random());
  words[random() % kWordLanes] = INT16_MAX;
  return words;
}

void checkPixels(std::mt19937& random) {
  const auto pixels = randomPixels(random), others = randomPixels(random);
  const Words words = wordPixels(pixels.data() + 3), both = wordPixels(pixels.data(), others.data());
  const Bytes bits = bitCounts(load(pixels.data()));
  const Words differences = differencesOfEight(pixels.data(), others.data());
  std::array<std::uint8_t, kWordLanes> back;
  storeWordsAsBytes(back.data(), words);
  for (int i = 0; i < kWordLanes; ++i) {
    EXPECT_EQ(words[i], pixels[i + 3]);
    EXPECT_EQ(back[i], pixels[i + 3]);
    EXPECT_EQ(both[i], i < 8 ? pixels[i] : others[i - 8]);
    int sum = 0;
    for (int k = 0; k < 8; ++k) sum += std::abs(pixels[i + k] - others[k]);
    EXPECT_EQ(differences[i], sum);
  }
  for (int i = 0; i < kByteLanes; ++i) EXPECT_EQ(bits[i], std::popcount(pixels[i]));
  SixteenBytes a, b;
  std::memcpy(&a, pixels.data(), sizeof a);
  std::memcpy(&b, others.data(), sizeof b);
  int sum = 0;
  for (int i = 0; i < 16; ++i) sum += std::abs(pixels[i] - others[i]);
  EXPECT_EQ(differenceOf(a, b), sum);
}

void checkWords(std::mt19937& random) {
  const auto a = randomWords(random), b = randomWords(random);
  const Words x = load(a.data()), y = load(b.data()), fractions = scaled(x, y), small = x >> 4;
  const FourSums sums =
      totals(products(small, small), products(small, y), products(y >> 4, y >> 4), products(allWords(1), x));
  std::array<int, 4> expected{};
  for (int i = 0; i < kWordLanes; ++i) {
    EXPECT_EQ(fractions[i], (a[i] * b[i] + (1 << 14)) >> 15) << a[i] << " " << b[i];
    expected[0] += (a[i] >> 4) * (a[i] >> 4), expected[1] += (a[i] >> 4) * b[i];
    expected[2] += (b[i] >> 4) * (b[i] >> 4), expected[3] += a[i];
    EXPECT_EQ(magnitude(small)[i], std::abs(a[i] >> 4));
  }
  for (int i = 0; i < 4; ++i) EXPECT_EQ(sums[i], expected[i]);
  EXPECT_EQ(leastOf(magnitude(small)),
            std::abs(*std::ranges::min_element(a, {}, [](int v) { return std::abs(v >> 4); }) >> 4));
}

void checkMasks() {
  constexpr std::array<float, kFloatLanes> kNumbers{3, -1, 4, -1, 5, -9, 2, 6};
  const Floats numbers = load(kNumbers.data());
  EXPECT_EQ(bitsOf(numbers < 0.0F), 0b00101010U);
  EXPECT_TRUE(anyOf(numbers > 5.0F));
  EXPECT_FALSE(anyOf(numbers > 6.0F));
  const Floats chosen = choose(numbers < 0.0F, -numbers, numbers + 1.0F);
  for (int i = 0; i < kFloatLanes; ++i) EXPECT_EQ(chosen[i], kNumbers[i] < 0 ? -kNumbers[i] : kNumbers[i] + 1);
}

}  // namespace

void checkLanes() {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) checkPixels(random), checkWords(random);
  checkMasks();
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(checkLanes);

namespace {

TEST(PixelLanes, ComputeTheSameWithAllInstructions) {
  const int best = (chooseInstructions(), chosen_instructions);
  for (int version = 0; version <= best; ++version) {
    chosen_instructions = version;
    SCOPED_TRACE(instructionSet());
    MOTORCADE_KERNEL(checkLanes)();
  }
  chooseInstructions();
}

}  // namespace
}  // namespace motorcade
#endif
