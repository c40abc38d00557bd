#include "apps/inject/fault_injector.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "apps/inject/image_faults.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kWidth = 64, kHeight = 48;

Image picture(unsigned seed) { return test::render(kWidth, kHeight, test::Texture(seed)); }

bool same(const Image& a, const Image& b) {
  for (int y = 0; y < kHeight; ++y)
    if (!std::equal(a.row(y), a.row(y) + kWidth, b.row(y))) return false;
  return true;
}

/// Output of an injector, and its order in words.
struct Outcome {
  std::vector<StereoFrame> frames;
  std::string order;  // +3: pair 3 came; -3: it was passed over
  double waited_s = 0;
};

Outcome inject(const std::string& spec, int frames) {
  Sequence sequence;
  sequence.frames.resize(static_cast<std::size_t>(frames));
  FaultInjector injector(parseFaultSpec(spec), sequence);
  Outcome outcome;
  const FaultInjector::Outlet outlet{
      .push =
          [&](StereoFrame frame) {
            outcome.order.append("+").append(std::to_string(frame.head.frame.value));
            outcome.frames.push_back(std::move(frame));
            return true;
          },
      .pass_over = [&](FrameId frame, Timestamp) { outcome.order.append("-").append(std::to_string(frame.value)); },
      .wait = [&](std::chrono::duration<double> time) { outcome.waited_s += time.count(); }};
  for (int i = 0; i < frames; ++i) {
    StereoFrame frame;
    frame.head.frame = {i};
    frame.head.stamp = {i * 100};
    frame.left = picture(static_cast<unsigned>(i));
    frame.right = picture(static_cast<unsigned>(100 + i));
    EXPECT_TRUE(injector.give(std::move(frame), outlet));
  }
  EXPECT_TRUE(injector.finish(outlet));
  return outcome;
}

TEST(FaultInjector, TakesTheRightImageOfSoManyPairsBefore) {
  const Outcome outcome = inject("apart=2@1:", 4);
  EXPECT_TRUE(same(outcome.frames[0].right, picture(100)));
  EXPECT_TRUE(same(outcome.frames[1].right, picture(100))) << "there is none before";
  EXPECT_TRUE(same(outcome.frames[3].right, picture(101)));
  EXPECT_TRUE(same(outcome.frames[3].left, picture(3)));
}

TEST(FaultInjector, LeavesPairsAsTheyAreWhereNothingStrikes) {
  const Outcome outcome = inject("black@7", 3);
  EXPECT_EQ(outcome.order, "+0+1+2");
  for (const StereoFrame& frame : outcome.frames) EXPECT_TRUE(same(frame.left, picture(frame.head.frame.value)));
}

TEST(FaultInjector, DropsDelaysAndReordersPairs) {
  EXPECT_EQ(inject("drop@1:3", 4).order, "+0-1-2+3");
  EXPECT_EQ(inject("reordered@1", 4).order, "+0-1+2+1+3");
  EXPECT_EQ(inject("late=2@0", 4).order, "-0+1+2+0+3");
  EXPECT_EQ(inject("late=5@2", 4).order, "+0+1-2+3+2");  // at the end
  EXPECT_EQ(inject("stall=1.5@1", 3).waited_s, 1.5);
}

TEST(FaultInjector, TimesStayLaterAfterAJump) {
  const Outcome outcome = inject("jump=1@1", 3);
  EXPECT_EQ(outcome.frames[0].head.stamp.ns, 0);
  EXPECT_EQ(outcome.frames[1].head.stamp.ns, 1'000'000'100);
  EXPECT_EQ(outcome.frames[2].head.stamp.ns, 1'000'000'200);
}

TEST(FaultInjector, ChangesTheImagesOfTheSideThatIsNamed) {
  const Outcome outcome = inject("duplicate@1,exchanged@2,one_eyed@3,black/left@4", 5);
  EXPECT_TRUE(same(outcome.frames[1].left, picture(0)) && same(outcome.frames[1].right, picture(100)));
  EXPECT_TRUE(same(outcome.frames[2].left, picture(102)) && same(outcome.frames[2].right, picture(2)));
  EXPECT_TRUE(!outcome.frames[3].left.empty() && outcome.frames[3].right.empty());
  EXPECT_EQ(outcome.frames[4].left.at(5, 5), 0);
  EXPECT_TRUE(same(outcome.frames[4].right, picture(104)));
}

TEST(FaultInjector, ARightImageCanComeFromThePairBefore) {
  const Outcome outcome = inject("apart", 3);
  for (const int frame : {1, 2}) {
    EXPECT_TRUE(same(outcome.frames[frame].left, picture(frame)));
    EXPECT_TRUE(same(outcome.frames[frame].right, picture(100 + frame - 1)));
  }
}

TEST(FaultInjector, IsTheSameForTheSameSeed) {
  const Outcome once = inject("noise=20,seed=3", 2), again = inject("noise=20,seed=3", 2),
                other = inject("noise=20,seed=4", 2);
  EXPECT_TRUE(same(once.frames[1].left, again.frames[1].left));
  EXPECT_FALSE(same(once.frames[1].left, other.frames[1].left));
  EXPECT_FALSE(same(once.frames[1].left, once.frames[0].left));
}

TEST(ImageFaults, DoWhatTheirNamesSay) {
  ImagePool pool;
  const Image image = picture(1);
  double mean = 0, squares = 0;
  const Image noisy = withNoise(image, 10, 5, pool), flat = blurred(filled(image, 80, pool), 9, pool),
              brighter = exposed(image, 1.2, pool), soft = blurred(image, 9, pool), poor = throughJpeg(image, 10, pool);
  double contrast = 0, soft_contrast = 0, jpeg_error = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 1; x < kWidth; ++x) {
      const double difference = noisy.at(x, y) - image.at(x, y);
      mean += difference, squares += difference * difference;
      EXPECT_EQ(flat.at(x, y), 80);
      EXPECT_NEAR(brighter.at(x, y), std::min(255.0, 1.2 * image.at(x, y)), 0.5);
      contrast += std::abs(image.at(x, y) - image.at(x - 1, y));
      soft_contrast += std::abs(soft.at(x, y) - soft.at(x - 1, y));
      jpeg_error += std::abs(poor.at(x, y) - image.at(x, y));
    }
  }
  const double pixels = kHeight * (kWidth - 1);
  EXPECT_NEAR(mean / pixels, 0, 1);
  EXPECT_NEAR(std::sqrt(squares / pixels), 10, 1);
  EXPECT_LT(soft_contrast, 0.5 * contrast);
  EXPECT_GT(jpeg_error / pixels, 1);
  EXPECT_LT(jpeg_error / pixels, 20);
  EXPECT_NE(withBitFlips(std::string(20, 'a'), 3, 1), std::string(20, 'a'));
}

TEST(ImageFaults, MoveTheContentAsTheyTell) {
  constexpr int kSide = 201, kMiddle = 100;
  ImagePool pool;
  Image image = filled(pool.acquire(kSide, kSide), 20, pool);
  for (int y = 98; y <= 102; ++y)
    for (int x = 158; x <= 162; ++x) image.mutableRow(y)[x] = 220;  // a spot 60 px right of the middle
  const auto spot = [](const Image& moved) {
    double u = 0, v = 0, sum = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double weight = moved.at(x, y) - 20.0;
        u += weight * (x - kMiddle), v += weight * (y - kMiddle), sum += weight;
      }
    return std::pair(u / sum, v / sum);
  };
  EXPECT_NEAR(spot(lowered(image, 2.5, pool)).second, 2.5, 0.05);
  EXPECT_NEAR(spot(zoomed(image, 1.05, pool)).first, 63, 0.1);
  EXPECT_NEAR(spot(rolled(image, 0.1, pool)).first, 60 * std::cos(0.1), 0.1);
  EXPECT_NEAR(spot(rolled(image, 0.1, pool)).second, 60 * std::sin(0.1), 0.1);  // rows go down: clockwise
  EXPECT_NEAR(spot(distorted(image, -0.2, pool)).first, 60 * (1 - 0.2 * 0.36), 0.3);
}

}  // namespace
}  // namespace motorcade
