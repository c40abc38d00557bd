#include "apps/watch/input_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "frontend/image/grain.hpp"
#include "frontend/image/image_pyramid.hpp"

namespace motorcade {
namespace {

/// Least share of matches in their row if rows agree: over 0.8 on all drives at hand, under 0.6 when a frame apart.
constexpr double kInRowShare = 0.75;
// Effects on the rows above which an error is reported, and above which results are worthless [px].
constexpr double kTold_px = 0.8, kWorthless_px = 1.2;
constexpr double kTogether_px = 1.5;  // of all errors; good calibrations stay below 0.6
constexpr double kSure = 5;           // standard deviations
constexpr double kSureDistorted = 4;  // as the least displacement below asks for much already
/// Displacement in the corner of the image above which distortion is reported: good calibrations stay below half of it
/// [px].
constexpr double kDistorted_px = 20;

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[1200];  // three numbers of any size, and a sentence
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

double meanGray(const Image& image) {
  constexpr int kStep_px = 8;
  std::int64_t sum = 0, count = 0;
  for (int y = kStep_px / 2; y < image.height(); y += kStep_px)
    for (int x = kStep_px / 2; x < image.width(); x += kStep_px, ++count) sum += image.at(x, y);
  return static_cast<double>(sum) / static_cast<double>(std::max<std::int64_t>(1, count));
}

double degrees(double angle_rad) { return angle_rad * 180 / std::numbers::pi; }

/// Format of an error of the rows: value and standard deviation are in its units.
struct RowErrorText {
  RowError error;
  const char* name;
  const char* format;
  double unit = 1;
};

const double kDegree = degrees(1);
const std::array kRowErrorTexts{
    RowErrorText{RowError::kOffset, "rows", "the right image's content lies %.2f (+-%.2f) px lower than the left's"},
    RowErrorText{RowError::kRoll, "roll", "the right image is turned by %.2f (+-%.2f) degrees about its middle",
                 kDegree},
    RowErrorText{RowError::kZoom, "zoom", "the right image is larger by %.2f (+-%.2f) %%", 100},
    RowErrorText{RowError::kYaw, "yaw", "the right camera looks to the side by %.2f (+-%.2f) degrees", kDegree},
    RowErrorText{RowError::kLift, "lift", "the right camera stands higher by %.1f (+-%.1f) %% of the baseline", 100},
    RowErrorText{RowError::kAhead, "ahead", "the right camera stands ahead by %.1f (+-%.1f) %% of the baseline", 100}};

/// Numbers of matches clearly before the cameras, and clearly behind them.
std::pair<double, double> aheadAndBehind(std::span<const EpipolarMatch> matches) {
  constexpr double kClear_px = 1.5, kRow_px = 3;
  std::pair<double, double> counts{0, 0};
  for (const EpipolarMatch& match : matches) {
    if (std::abs(match.rowDifference_px()) > kRow_px) continue;
    counts.first += match.disparity_px() > kClear_px ? 1 : 0;
    counts.second += match.disparity_px() < -kClear_px ? 1 : 0;
  }
  return counts;
}

}  // namespace

void InputCheck::observe(const StereoFrame& pair) {
  constexpr std::size_t kPoints = 150, kFewestOfPair = kFewestMatches / kPairs;
  if (complete() || pair.head.frame <= last_) return;
  last_ = pair.head.frame;
  stamps_.push_back(pair.head.stamp);
  if (!isWhole(pair)) return;
  PreparedPair now = preparePair(pair.left, pair.right, pool_);
  const auto matches = matchUnrectified(now.left, now.right, now.corners, kPoints);
  if (matches.size() < kFewestOfPair) {
    ++passed_over_;
    return before_.reset();
  }
  ++pairs_;
  observeLight(pair);
  compareWithNeighbors(now, matches);
  matches_.insert(matches_.end(), matches.begin(), matches.end());
  looks_.emplace_back(pair.head.frame, matches_.size());
  before_ = std::move(now);
}

void InputCheck::observeLight(const StereoFrame& pair) {
  left_means_.push_back(meanGray(pair.left));
  right_means_.push_back(meanGray(pair.right));
  if (const auto grain = grainOf(pair.left)) left_grains_.push_back(grain->smooth_gray);
  if (const auto grain = grainOf(pair.right)) right_grains_.push_back(grain->smooth_gray);
}

/// Matches with the neighboring pairs only if the pair's own rows agree badly, as it costs as much again, twice.
void InputCheck::compareWithNeighbors(const PreparedPair& now, std::span<const EpipolarMatch> matches) {
  constexpr double kBetter = 1.5;
  constexpr std::size_t kFew = 15, kPoints = 150;
  if (!before_) return;
  ++apart_.compared;
  const std::size_t in_row = matchesInRow(matches);
  if (static_cast<double>(in_row) > kInRowShare * static_cast<double>(std::max(matches.size(), 2 * kFew))) return;
  ++apart_.bad;
  const double own = kBetter * static_cast<double>(std::max(in_row, kFew));
  const auto with_before = matchesInRow(matchUnrectified(now.left, before_->right, now.corners, kPoints));
  const auto with_after = matchesInRow(matchUnrectified(before_->left, now.right, before_->corners, kPoints));
  if (static_cast<double>(with_before) > own && with_before > with_after) ++apart_.before;
  if (static_cast<double>(with_after) > own && with_after > with_before) ++apart_.after;
}

std::vector<Finding> InputCheck::findings() const {
  std::vector<Finding> findings = rigFindings();
  addLight(findings);
  addTimes(findings);
  addPoints(findings);
  return findings;
}

std::vector<Finding> InputCheck::rigFindings() const {
  std::vector<Finding> findings;
  if (const auto found = apart()) return {*found};
  if (const auto found = exchanged()) return {*found};
  if (matches_.size() < kFewestMatches) return {};
  const PairGeometry geometry = this->geometry();
  if (const auto found = incoherent(geometry)) return {*found};
  addRowErrors(geometry, findings);
  return findings;
}

/// Reports pairs whose images belong to different pairs. A few such pairs make results worse, not worthless, as a run
/// bridges them.
std::optional<Finding> InputCheck::apart() const {
  constexpr std::size_t kMinPairs = 3;
  const std::size_t most = std::max(apart_.before, apart_.after);
  if (most < kMinPairs || 2 * most < apart_.bad) return std::nullopt;
  return Finding{"apart",
                 text("the images of a pair are not taken at the same time: in %zu of %zu pairs, the left image fits "
                      "the right one of the pair %s better; number the images by their times",
                      most, apart_.compared, apart_.before > apart_.after ? "after" : "before"),
                 4 * most >= apart_.compared};
}

/// Reports images that fit those of no other pair better. They were taken apart by a part of the frames' distance.
std::optional<Finding> InputCheck::incoherent(const PairGeometry& geometry) const {
  constexpr double kAgreeingShare = 0.75;
  if (geometry.agreeing_share > kAgreeingShare || 2 * apart_.bad < apart_.compared) return std::nullopt;
  return Finding{"apart",
                 text("the images of a pair are not taken at the same time, or not by one rig: in %zu of %zu pairs, "
                      "rows differ as no error of the cameras' places explains; pair the images by their times",
                      apart_.bad, apart_.compared),
                 true};
}

bool looksExchanged(std::span<const EpipolarMatch> matches) {
  constexpr double kShare = 0.25;
  const auto [ahead, behind] = aheadAndBehind(matches);
  return behind >= kShare * static_cast<double>(matches.size()) && behind >= 3 * ahead;
}

std::optional<Finding> InputCheck::exchanged() const {
  if (matches_.size() < kFewestMatches || !looksExchanged(matches_)) return std::nullopt;
  const auto [ahead, behind] = aheadAndBehind(matches_);
  const auto all = static_cast<double>(matches_.size());
  return Finding{"exchanged",
                 text("left and right image are exchanged: %.0f %% of the points would lie behind the camera, %.0f %% "
                      "before it; exchange the folders, or P0 and P1 of the calibration",
                      100 * behind / all, 100 * ahead / all),
                 true};
}

/// Adds row errors. Errors that nothing in view separates, as before a wall, are uncertain each, but not together.
void InputCheck::addRowErrors(const PairGeometry& geometry, std::vector<Finding>& findings) {
  const RowErrorEstimate& barrel = geometry[RowError::kBarrel];
  if (barrel.effect_px > kDistorted_px && std::abs(barrel.value) > kSureDistorted * barrel.sigma)
    findings.push_back(
        {"distortion",
         text("the images are distorted: k1 %.3f (+-%.3f), %.0f px in the corners; undistort and rectify "
              "them, or give their calibration",
              barrel.value, barrel.sigma, barrel.effect_px),
         true});
  for (const RowErrorText& entry : kRowErrorTexts) {
    const RowErrorEstimate& estimate = geometry[entry.error];
    if (estimate.effect_px < kTold_px || std::abs(estimate.value) < kSure * estimate.sigma) continue;
    findings.push_back({entry.name,
                        text(entry.format, entry.unit * estimate.value, entry.unit * estimate.sigma) +
                            text(": %.1f px between the rows; rectify the images anew", estimate.effect_px),
                        estimate.effect_px > kWorthless_px});
  }
  if (std::ranges::none_of(findings, &Finding::worthless) && geometry.explained_px > kTogether_px)
    findings.push_back({"rows",
                        text("rows of the left and the right image differ by %.1f px, by which error these pairs do "
                             "not tell; rectify the images anew",
                             geometry.explained_px),
                        true});
}

std::vector<LookedAt> InputCheck::looks() const {
  std::vector<LookedAt> looks;
  std::size_t begin = 0;
  for (const auto& [frame, end] : looks_) {
    looks.push_back({frame, std::span(matches_).subspan(begin, end - begin)});
    begin = end;
  }
  return looks;
}

LightMeasures InputCheck::light() const {
  LightMeasures light;
  for (std::size_t i = 0; i < left_means_.size(); ++i) {
    const auto ratio = [](double a, double b) { return std::max(a, b) / std::max(1.0, std::min(a, b)); };
    light.sides = std::max(light.sides, ratio(left_means_[i], right_means_[i]));
    if (i > 0) light.jump = std::max(light.jump, ratio(left_means_[i], left_means_[i - 1]));
    light.left_level += left_means_[i] / static_cast<double>(left_means_.size());
    light.right_level += right_means_[i] / static_cast<double>(left_means_.size());
  }
  light.left_grain = median(left_grains_);
  light.right_grain = median(right_grains_);
  return light;
}

void InputCheck::addLight(std::vector<Finding>& findings) const {
  constexpr double kJump = 1.35, kSides = 1.6, kBlurred = 0.4, kUnlike = 2.5, kNoisy = 8;
  const LightMeasures light = this->light();
  if (light.jump > kJump)
    findings.push_back({"exposure",
                        text("the exposure jumps by %.2f times from one pair to the next; hold it, or let it "
                             "change slowly",
                             light.jump),
                        false});
  if (light.sides > kSides)
    findings.push_back({"exposure",
                        text("one image of a pair is %.2f times as bright as the other; let both cameras "
                             "have the same exposure",
                             light.sides),
                        false});
  if (left_grains_.empty() || right_grains_.empty()) return;
  const double left = light.left_grain, right = light.right_grain;
  if (std::min(left, right) < kBlurred || std::max(left, right) > kUnlike * std::min(left, right))
    findings.push_back({"blur",
                        text("images are blurred, smoothed or strongly compressed: the grain is %.2f gray levels "
                             "on the left, %.2f on the right, of a sharp image 1 to 3; look at focus and "
                             "compression",
                             left, right),
                        false});
  if (std::max(left, right) > kNoisy)
    findings.push_back(
        {"noise",
         text("images are noisy: about %.0f gray levels; more light or less gain helps", std::max(left, right)),
         false});
}

TimeMeasures InputCheck::times() const {
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < stamps_.size(); ++i) periods_s.push_back(secondsBetween(stamps_[i - 1], stamps_[i]));
  if (periods_s.empty()) return {};
  const auto [least, most] = std::ranges::minmax(periods_s);
  return {median(periods_s), least, most};
}

void InputCheck::addTimes(std::vector<Finding>& findings) const {
  constexpr double kJump = 4;
  constexpr std::size_t kFewest = 4;
  if (stamps_.size() < kFewest) return;
  const TimeMeasures times = this->times();
  const bool late = times.most_s > kJump * times.usual_s;
  if (late || times.least_s <= 0)
    findings.push_back({"times",
                        text("the times jump: pairs are %.4g s apart, but once %.4g s; look at times.txt",
                             times.usual_s, late ? times.most_s : times.least_s),
                        false});
}

/// Reports too few matches; results are worthless if no pair shows any, because nothing can be tracked then.
void InputCheck::addPoints(std::vector<Finding>& findings) const {
  if (matches_.size() >= kFewestMatches || passed_over_ + pairs_ == 0) return;
  findings.push_back({"points",
                      text("only %zu points are seen in both images of %zu pairs: nothing can be told of their rows; "
                           "look at the images",
                           matches_.size(), passed_over_ + pairs_),
                      pairs_ == 0});
}

}  // namespace motorcade
