#include "apps/watch/rig_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace motorcade {
namespace {

/// Points of a glance, and the fewest matches by which it decides.
constexpr std::size_t kGlancePoints = 80, kFewestOfGlance = 15;
/// Least share of matches that lie within a pixel of the row predicted by the rig's usual geometry. The share is over
/// 0.8 on all drives at hand, and under 0.6 where images are a frame apart.
constexpr double kAgreeingRows_px = 1, kAgreeingShare = 0.7;
/// Consecutive agreeing glances after which a worthless rig is good again.
constexpr int kAgreeingGlances = 3;
/// Longest pause after glances that were found to be mistaken [pairs].
constexpr int kMostPatience = 80;

}  // namespace

std::string RigFinding::text() const {
  if (!last_good) return finding.text;
  return "between frames " + std::to_string(last_good->value) + " and " + std::to_string(first_bad.value) +
         " the pairs changed: " + finding.text;
}

std::vector<RigFinding> RigWatch::observe(const StereoFrame& pair) {
  if (auto finding = frozen(pair)) return {*std::move(finding)};
  if (!check_) glance(pair);
  if (!check_) return {};
  check_->observe(pair);
  return check_->complete() ? judge() : std::vector<RigFinding>{};
}

std::vector<RigFinding> RigWatch::finish() {
  const bool enough = check_ && (!started_ || check_->pairs() >= kVerifiedBy / 2);
  return enough ? judge() : std::vector<RigFinding>{};
}

/// Reports a camera that hangs. Its pairs tell nothing of the rig.
std::optional<RigFinding> RigWatch::frozen(const StereoFrame& pair) {
  const auto side = isWhole(pair) ? frozen_camera_.observe(pair) : std::nullopt;
  if (!side) return std::nullopt;
  worthless_ = true;
  if (started_) check_.reset();
  return RigFinding{findingOf(*side), side->last_good, pair.head.frame};
}

/// Starts a check, pair by pair, if this pair disagrees with the usual rig.
void RigWatch::glance(const StereoFrame& pair) {
  if (!isWhole(pair) || --until_glance_ > 0) return;
  until_glance_ = patience_;
  const bool good = agrees(pair);
  agreeing_ = good ? agreeing_ + 1 : 0;
  if (worthless_) {
    worthless_ = agreeing_ < kAgreeingGlances;
  } else if (good) {
    last_good_ = pair.head.frame;
    until_glance_ = patience_ = kGlanceEvery;
  } else {
    first_bad_ = pair.head.frame;
    check_.emplace(camera_, kVerifiedBy);
  }
}

/// True if the rows agree. The verdict stays if there are too few matches to decide.
bool RigWatch::agrees(const StereoFrame& pair) {
  const PreparedPair now = preparePair(pair.left, pair.right, pool_);
  const auto matches = matchUnrectified(now.left, now.right, now.corners, kGlancePoints);
  if (matches.size() < kFewestOfGlance) return !worthless_;
  const auto agreeing = std::ranges::count_if(matches, [&](const EpipolarMatch& match) {
    const double predicted_px =
        predictedRowError_px(usual_, camera_, match.u_left_px, match.v_left_px, match.disparity_px());
    return std::abs(match.rowDifference_px() - predicted_px) < kAgreeingRows_px;
  });
  return !looksExchanged(matches) &&
         static_cast<double>(agreeing) >= kAgreeingShare * static_cast<double>(matches.size());
}

/// Judges the rig. It becomes the usual one, unless it is worthless or has too few matches.
std::vector<RigFinding> RigWatch::judge() {
  const InputCheck check = *std::exchange(check_, std::nullopt);
  std::vector<RigFinding> found;
  for (Finding& finding : started_ ? check.rigFindings() : check.findings()) {
    worthless_ = worthless_ || finding.worthless;
    const bool is_new = told_.insert(finding.name).second;
    if (is_new || finding.worthless) found.push_back({std::move(finding), last_good_, first_bad_});
  }
  patience_ = started_ && !worthless_ ? std::min(2 * patience_, kMostPatience) : kGlanceEvery;
  until_glance_ = patience_;
  started_ = true;
  if (worthless_ || check.matches().size() < InputCheck::kFewestMatches) return found;
  usual_ = check.geometry();
  last_good_ = check.looks().back().frame;
  return found;
}

}  // namespace motorcade
