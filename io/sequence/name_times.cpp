#include <algorithm>
#include <charconv>
#include <chrono>
#include <functional>
#include <limits>
#include <string>

#include "io/sequence/image_names.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kNameSecond_ns = 1'000'000'000, kNameMillisecond_ns = 1'000'000, kNameMicrosecond_ns = 1'000;
/// Range of seconds since 1970 that count as times. Before 2004 numbers rather count from a round one. Until 2112, 63
/// bits of nanoseconds also hold differences.
constexpr std::int64_t kEarliest_s = 1'100'000'000, kLatest_s = 4'500'000'000;

bool isClockTime_s(std::int64_t value_s) { return value_s >= kEarliest_s && value_s < kLatest_s; }

std::optional<std::int64_t> wholeNumber(const std::string& digits) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

/// Digits after the point, to the nanosecond.
std::int64_t fraction_ns(std::string digits) {
  constexpr std::size_t kMostDigits = 9;
  digits.resize(kMostDigits, '0');
  return wholeNumber(digits).value();
}

/// Parses YYYYMMDDhhmmss and the digits of a fraction of a second.
std::optional<std::int64_t> dateDigits_ns(const std::string& digits) {
  constexpr std::size_t kWithoutFraction = 14, kMost = kWithoutFraction + 9;
  if (digits.size() < kWithoutFraction || digits.size() > kMost) return std::nullopt;
  const auto field = [&](std::size_t begin, std::size_t count) {
    return static_cast<int>(*wholeNumber(digits.substr(begin, count)));
  };
  using std::chrono::year_month_day, std::chrono::year, std::chrono::month, std::chrono::day;
  const year_month_day date{year(field(0, 4)), month(static_cast<unsigned>(field(4, 2))),
                            day(static_cast<unsigned>(field(6, 2)))};
  const int hour = field(8, 2), minute = field(10, 2), second = field(12, 2);
  if (!date.ok() || date.year() < year(1970) || date.year() > year(2100) || hour > 23 || minute > 59 || second > 60)
    return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return (((days * 24 + hour) * 60 + minute) * 60 + second) * kNameSecond_ns +
         fraction_ns(digits.substr(kWithoutFraction));
}

/// The digits of a date that begins with this part: as one number, as a day and a time of day, or each number by
/// itself. A fraction of the second may follow.
std::string dateFrom(const NameParts& name, std::size_t part) {
  constexpr std::size_t kUpToSeconds = 14, kDay = 8, kYear = 4, kOthers = 2;
  std::string digits = name[part];
  if (digits.size() != kDay && digits.size() != kYear) return digits;
  const std::size_t begun = digits.size();
  for (part += 2; part < name.size() && digits.size() < kUpToSeconds; part += 2) {
    if (begun == kYear && name[part].size() != kOthers) return {};
    digits += name[part];
  }
  const bool fraction = digits.size() == kUpToSeconds && part < name.size();
  return fraction ? digits + name[part] : digits;
}

std::optional<std::int64_t> date_ns(const NameParts& name, const std::vector<NameParts>&) {
  for (std::size_t part = 1; part < name.size(); part += 2)
    if (const auto time_ns = dateDigits_ns(dateFrom(name, part))) return time_ns;
  return std::nullopt;
}

bool varies(const std::vector<NameParts>& names, std::size_t part) {
  return std::ranges::any_of(names, [&](const NameParts& name) { return name[part] != names.front()[part]; });
}

bool isOneWidth(const std::vector<NameParts>& names, std::size_t part) {
  return std::ranges::all_of(names,
                             [&](const NameParts& name) { return name[part].size() == names.front()[part].size(); });
}

/// Seconds since 1970 and, as a second number, their fraction or nanoseconds. Two varying numbers around a decimal
/// point may be seconds of any clock.
std::optional<std::int64_t> secondsAndMore_ns(const NameParts& name, const std::vector<NameParts>& names) {
  constexpr std::size_t kMostDigits = 9;
  for (std::size_t part = 1; part + 2 < name.size(); part += 2) {
    const std::string& rest = name[part + 2];
    const auto whole_s = wholeNumber(name[part]);
    const bool point = name[part + 1] == ".", goes_on = point && varies(names, part) && varies(names, part + 2);
    if (!whole_s || *whole_s >= kLatest_s || (!goes_on && !isClockTime_s(*whole_s)) || rest.size() > kMostDigits)
      continue;
    const bool fraction = point || (isOneWidth(names, part + 2) && rest.size() % 3 == 0);
    return *whole_s * kNameSecond_ns + (fraction ? fraction_ns(rest) : wholeNumber(rest).value());
  }
  return std::nullopt;
}

/// Milliseconds with a fraction.
std::optional<std::int64_t> milliseconds_ns(const NameParts& name, const std::vector<NameParts>& names) {
  constexpr std::int64_t kMost = kLatest_s * 1'000;
  for (std::size_t part = 1; part + 2 < name.size(); part += 2) {
    const auto whole = wholeNumber(name[part]);
    if (name[part + 1] == "." && whole && *whole < kMost && name[part + 2].size() <= 9 && varies(names, part) &&
        varies(names, part + 2))
      return *whole * kNameMillisecond_ns + fraction_ns(name[part + 2]) / (kNameSecond_ns / kNameMillisecond_ns);
  }
  return std::nullopt;
}

std::int64_t medianStep(const std::vector<std::int64_t>& values) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

/// The unit of whole numbers, or 0 where they merely count. Clocks that start with the device have large steps, but no
/// large numbers. A step of 4,000 or more is no count of images.
std::int64_t unitOfNames_ns(const std::vector<std::int64_t>& values) {
  constexpr std::int64_t kNanoseconds = 2'500'000, kMicroseconds = 4'000, kMostMilliseconds = 2'500, kMostSeconds = 10;
  const auto clockIn = [&](std::int64_t unit_ns) {
    return isClockTime_s(values.front() / (kNameSecond_ns / unit_ns)) &&
           isClockTime_s(values.back() / (kNameSecond_ns / unit_ns));
  };
  const std::int64_t step = medianStep(values);
  if (clockIn(1)) return 1;
  if (clockIn(kNameMicrosecond_ns) && step < kNanoseconds) return kNameMicrosecond_ns;
  if (clockIn(kNameMillisecond_ns) && step <= kMostMilliseconds) return kNameMillisecond_ns;
  if (clockIn(kNameSecond_ns) && step <= kMostSeconds) return kNameSecond_ns;
  if (step >= kNanoseconds) return 1;
  return step >= kMicroseconds ? kNameMicrosecond_ns : 0;
}

std::optional<NameTimes> wholeNumberTimes(const std::vector<NameParts>& names) {
  const auto varying = varyingDigits(names);
  if (varying.size() > 1 || names.front().size() < 2) return std::nullopt;
  const std::size_t part = varying.empty() ? names.front().size() - 1 - names.front().size() % 2 : *varying.begin();
  NameTimes times;
  for (const NameParts& name : names) {
    const auto number = wholeNumber(name[part]);
    if (!number) return std::nullopt;
    times.all_ns.push_back(*number);
  }
  times.unit_ns = unitOfNames_ns(times.all_ns);
  if (times.unit_ns == 0) return std::nullopt;
  if (times.all_ns.back() > std::numeric_limits<std::int64_t>::max() / times.unit_ns) return std::nullopt;
  for (std::int64_t& time_ns : times.all_ns) time_ns *= times.unit_ns;
  return times;
}

/// Checks that times are as far apart as images of a camera may be.
bool arePlausible(std::vector<std::int64_t> times_ns) {
  constexpr std::int64_t kLeastPeriod_ns = 500'000, kMostPeriod_ns = 10 * kNameSecond_ns;
  std::ranges::sort(times_ns);
  const std::int64_t period_ns = medianStep(times_ns);
  const bool differ = std::ranges::adjacent_find(times_ns) == times_ns.end();
  return differ && (times_ns.size() < 2 || (period_ns >= kLeastPeriod_ns && period_ns <= kMostPeriod_ns));
}

using TimeOfName = std::function<std::optional<std::int64_t>(const NameParts&, const std::vector<NameParts>&)>;

std::optional<NameTimes> timesBy(const TimeOfName& time_of, const std::vector<NameParts>& names,
                                 std::int64_t unit_ns = kNameSecond_ns) {
  NameTimes times{.all_ns = {}, .unit_ns = unit_ns};
  for (const NameParts& name : names) {
    const auto time_ns = time_of(name, names);
    if (!time_ns) return std::nullopt;
    times.all_ns.push_back(*time_ns);
  }
  return arePlausible(times.all_ns) ? std::optional(times) : std::nullopt;
}

}  // namespace

std::optional<NameTimes> timesOfNames(const std::vector<NameParts>& names) {
  if (names.empty()) return std::nullopt;
  if (auto times = timesBy(date_ns, names)) return times;
  if (auto times = timesBy(secondsAndMore_ns, names)) return times;
  if (auto times = timesBy(milliseconds_ns, names, kNameMillisecond_ns)) return times;
  auto times = wholeNumberTimes(names);
  return times && arePlausible(times->all_ns) ? times : std::nullopt;
}

}  // namespace motorcade
