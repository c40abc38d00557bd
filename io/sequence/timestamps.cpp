#include "io/sequence/timestamps.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// Latest time, in 2112. Differences of any two times then fit into 63 bits of nanoseconds, too.
constexpr std::int64_t kMaxTime_s = 4'500'000'000;

bool isDigits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

/// `12` or `12.000000345` of a unit, exactly.
std::optional<std::int64_t> plainTime_ns(std::string_view text, std::int64_t unit_ns) {
  constexpr std::size_t kFraction = 9;
  const auto point = text.find('.');
  std::string_view whole = text.substr(0, point);
  std::string fraction(point == std::string_view::npos ? "" : text.substr(point + 1));
  if (whole.empty() || !isDigits(whole) || !isDigits(fraction)) return std::nullopt;
  whole.remove_prefix(std::min(whole.find_first_not_of('0'), whole.size()));
  std::int64_t units = 0, billionths = 0;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), units);
  if (!whole.empty() && error != std::errc()) return std::nullopt;
  if (units >= kMaxTime_s * (kSecond_ns / unit_ns)) return std::nullopt;
  fraction.resize(kFraction, '0');
  std::from_chars(fraction.data(), fraction.data() + fraction.size(), billionths);
  return units * unit_ns + billionths / (kSecond_ns / unit_ns);
}

/// `12` or `12.000000345`, exactly.
std::optional<std::int64_t> plainSeconds_ns(std::string_view text) { return plainTime_ns(text, kSecond_ns); }

std::optional<std::int64_t> dateTime_ns(const std::string& text) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, used = 0;
  if (std::sscanf(text.c_str(), "%4d-%2d-%2d%*1[ T]%2d:%2d:%n", &year, &month, &day, &hour, &minute, &used) != 5 ||
      used == 0)
    return std::nullopt;
  const auto seconds_ns = plainSeconds_ns(std::string_view(text).substr(static_cast<std::size_t>(used)));
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!seconds_ns || !date.ok() || hour > 23 || minute > 59) return std::nullopt;
  constexpr std::int64_t kMinute_s = 61;  // one may have a leap second
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count(),
                     minutes_s = ((days * 24 + hour) * 60 + minute) * 60;
  if (std::abs(minutes_s) >= kMaxTime_s || *seconds_ns >= kMinute_s * kSecond_ns) return std::nullopt;
  return minutes_s * kSecond_ns + *seconds_ns;
}

Timestamp parseTime(const std::filesystem::path& file, const TextLine& line, std::int64_t unit_ns) {
  FieldReader fields(file, line);
  const std::string text = trimmed(line.text);
  if (const auto date_ns = dateTime_ns(text)) return {*date_ns};
  if (const auto plain_ns = plainTime_ns(text, unit_ns)) return {*plain_ns};
  const double time_s = fields.number("a time in seconds") * static_cast<double>(unit_ns) / kSecond_ns;
  fields.expectEnd();
  if (std::abs(time_s) >= static_cast<double>(kMaxTime_s))
    fields.fail("the time is out of range; seconds are expected");
  return {std::llround(time_s * 1e9)};
}

/// Appends a time; it must be later than the one before.
void append(std::vector<Timestamp>& stamps, Timestamp stamp, const std::filesystem::path& file, const TextLine& line) {
  if (!stamps.empty() && stamp <= stamps.back())
    FieldReader(file, line).fail("the time is not later than the one before");
  stamps.push_back(stamp);
}

/// The numbers of the lines; empty where one is negative, or none.
std::vector<double> numbersIn(const std::vector<TextLine>& lines) {
  std::vector<double> numbers;
  for (const TextLine& line : lines) {
    const std::string text = trimmed(line.text);
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !(number >= 0)) return {};
    numbers.push_back(number);
  }
  return numbers;
}

/// Seconds, unless no camera takes images so far apart.
std::int64_t unitOf_ns(const std::vector<TextLine>& lines) {
  constexpr double kLeastPeriod_s = 4e-3, kMostPeriod_s = 2.5;  // of cameras
  const std::vector<double> numbers = numbersIn(lines);
  std::vector<double> periods;
  for (std::size_t i = 1; i < numbers.size(); ++i) periods.push_back(numbers[i] - numbers[i - 1]);
  if (periods.empty()) return kSecond_ns;
  std::ranges::sort(periods);
  const double least = periods.front(), usual = periods[periods.size() / 2];
  for (const std::int64_t unit_ns : {std::int64_t{1'000'000}, std::int64_t{1'000}, std::int64_t{1}}) {
    const double unit_s = static_cast<double>(unit_ns) / kSecond_ns;
    if (least * unit_s >= kLeastPeriod_s && usual * unit_s <= kMostPeriod_s) return unit_ns;
  }
  return kSecond_ns;
}

}  // namespace

Times parseTimes(const std::filesystem::path& file, const std::vector<TextLine>& lines) {
  Times times{.unit_ns = unitOf_ns(lines)};
  for (const TextLine& line : lines) append(times.stamps, parseTime(file, line, times.unit_ns), file, line);
  return times;
}

Times readTimes(const std::filesystem::path& file) {
  std::vector<TextLine> lines = readLines(file);
  std::erase_if(lines, [](const TextLine& line) { return trimmed(line.text).starts_with('#'); });
  return parseTimes(file, lines);
}

Timestamp readTime(const std::filesystem::path& file, const TextLine& line) {
  return parseTime(file, line, kSecond_ns);
}

std::vector<Timestamp> readTimestamps(const std::filesystem::path& file) { return readTimes(file).stamps; }

Timestamp stampAtRate(std::int64_t number, double rate_hz) {
  return {static_cast<std::int64_t>(std::llround(static_cast<double>(number) * 1e9 / rate_hz))};
}

std::string unitName(std::int64_t unit_ns) {
  if (unit_ns == kSecond_ns) return "seconds";
  if (unit_ns == 1) return "nanoseconds";
  return unit_ns == 1'000 ? "microseconds" : "milliseconds";
}

}  // namespace motorcade
