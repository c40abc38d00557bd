#include "health_monitor.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

namespace vehicle_stack {
namespace {

using PushStatus = motorcade::Tracker::Push::Status;

constexpr std::size_t kMostKept = 4096;  // of pushes and of results, however fast the camera is
constexpr std::size_t kFewest = 20;      // a share is told of so many at least: one bad pair of two is no half

double secondsBetween(HealthMonitor::Time from, HealthMonitor::Time to) {
  return std::chrono::duration<double>(to - from).count();
}

std::string text(const char* format, double value) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

template <class Entries>
void dropBefore(Entries& entries, HealthMonitor::Time time) {
  while (!entries.empty() && (entries.front().at < time || entries.size() > kMostKept)) entries.pop_front();
}

}  // namespace

const char* nameOf(Level level) {
  switch (level) {
    case Level::kStarting:
      return "starting";
    case Level::kHealthy:
      return "healthy";
    case Level::kDegraded:
      return "degraded";
    case Level::kBlind:
      return "blind";
  }
  return "";
}

HealthMonitor::HealthMonitor(const Limits& limits, Time start)
    : limits_(limits), start_(start), last_push_(start), last_result_(start), last_measured_(start) {}

void HealthMonitor::pushed(Time now, PushStatus status) {
  const std::scoped_lock lock(mutex_);
  last_push_ = now;
  pushes_.push_back({now, status});
  forgetBefore(now - limits_.window);
}

void HealthMonitor::received(Time now, const motorcade::Result& result) {
  const bool measured = result.status == motorcade::Result::Status::kGood;
  const bool sure = measured && result.cause == motorcade::Result::Cause::kNone;
  const std::scoped_lock lock(mutex_);
  last_result_ = now;
  if (measured) {
    last_measured_ = now;
    ++measured_;
  }
  results_.push_back({.at = now, .latency_ms = result.latency_ms, .sure = sure});
  forgetBefore(now - limits_.window);
}

void HealthMonitor::forgetBefore(Time time) {
  dropBefore(pushes_, time);
  dropBefore(results_, time);
}

std::optional<HealthMonitor::Change> HealthMonitor::check(Time now) {
  const std::scoped_lock lock(mutex_);
  forgetBefore(now - limits_.window);
  Finding finding = judged(now);
  if (level_ == Level::kStarting || finding.level > level_) return changeTo(finding.level, std::move(finding.reason));
  if (finding.level == level_) {
    better_since_.reset();
    return std::nullopt;
  }
  if (!better_since_) better_since_ = now;
  if (now - *better_since_ < limits_.recover_after) return std::nullopt;
  const Level one_better = level_ == Level::kBlind ? Level::kDegraded : Level::kHealthy;
  return changeTo(one_better, text("measuring again for %.1f s", secondsBetween(*better_since_, now)));
}

std::optional<HealthMonitor::Change> HealthMonitor::changeTo(Level level, std::string reason) {
  better_since_.reset();
  if (level == level_) return std::nullopt;
  return Change{.from = std::exchange(level_, level), .to = level, .reason = std::move(reason)};
}

HealthMonitor::Finding HealthMonitor::judged(Time now) const {
  if (level_ == Level::kStarting && measured_ < limits_.results_to_start) {
    if (now - start_ < limits_.start_within) return {Level::kStarting, ""};
    return {Level::kBlind, whyBlind(now)};
  }
  if (now - last_measured_ >= limits_.blind_after) return {Level::kBlind, whyBlind(now)};
  if (now - last_measured_ >= limits_.late_after)
    return {Level::kDegraded, text("nothing measured for %.2f s", secondsBetween(last_measured_, now))};
  return judgedShares();
}

/// Of several reasons, that which most likely is the cause of the others.
std::string HealthMonitor::whyBlind(Time now) const {
  if (now - last_push_ >= limits_.late_after)
    return text("the camera has given no pair for %.2f s", secondsBetween(last_push_, now));
  if (!pushes_.empty() && shareOf(PushStatus::kRejected) == 1) return "every pair is rejected";
  if (now - last_result_ >= limits_.late_after)
    return text("pairs go in, and no result has come for %.2f s", secondsBetween(last_result_, now));
  return text("only lost or rejected frames for %.2f s", secondsBetween(last_measured_, now));
}

HealthMonitor::Finding HealthMonitor::judgedShares() const {
  const double share = level_ == Level::kDegraded ? limits_.recover_share : 1;
  if (const double p99_ms = latencyOfWindow().p99_ms; p99_ms > share * limits_.most_latency_ms)
    return {Level::kDegraded, text("the 99th percentile of the latency is %.0f ms", p99_ms)};
  if (const double rejected = shareOf(PushStatus::kRejected); rejected > share * limits_.most_rejected)
    return {Level::kDegraded, text("%.0f %% of the pairs are rejected", 100 * rejected)};
  if (const double dropped = shareOf(PushStatus::kReplacedOlder); dropped > share * limits_.most_dropped)
    return {Level::kDegraded, text("%.0f %% of the pairs are dropped for newer ones", 100 * dropped)};
  const auto unsure = std::ranges::count(results_, false, &Arrival::sure);
  const auto results = static_cast<double>(std::max(results_.size(), kFewest));
  if (const double part = static_cast<double>(unsure) / results; part > share * limits_.most_unsure)
    return {Level::kDegraded, text("%.0f %% of the frames are lost or less sure", 100 * part)};
  return {Level::kHealthy, "measuring"};
}

double HealthMonitor::shareOf(PushStatus status) const {
  const auto pushes = static_cast<double>(std::max(pushes_.size(), kFewest));
  return static_cast<double>(std::ranges::count(pushes_, status, &Push::status)) / pushes;
}

HealthMonitor::Latency HealthMonitor::latencyOfWindow() const {
  if (results_.empty()) return {};
  std::vector<double> sorted_ms;
  sorted_ms.reserve(results_.size());
  for (const Arrival& result : results_) sorted_ms.push_back(result.latency_ms);
  std::ranges::sort(sorted_ms);
  const auto quantile = [&](double share) {
    return sorted_ms[static_cast<std::size_t>(share * static_cast<double>(sorted_ms.size() - 1))];
  };
  return {.p50_ms = quantile(0.5), .p99_ms = quantile(0.99), .max_ms = sorted_ms.back()};
}

Level HealthMonitor::level() const {
  const std::scoped_lock lock(mutex_);
  return level_;
}

HealthMonitor::Latency HealthMonitor::latency() const {
  const std::scoped_lock lock(mutex_);
  return latencyOfWindow();
}

}  // namespace vehicle_stack
