#include "io/timestamps.hpp"

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "io/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// Until 2112, so that also the time between any two fits into 63 bits of nanoseconds.
constexpr std::int64_t kMaxTime_s = 4'500'000'000;

bool isDigits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

/// `12` or `12.000000345`, exactly.
std::optional<std::int64_t> plainSeconds_ns(std::string_view text) {
  const auto point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  std::string fraction(point == std::string_view::npos ? "" : text.substr(point + 1));
  if (whole.empty() || whole.size() > 10 || !isDigits(whole) || !isDigits(fraction)) return std::nullopt;
  fraction.resize(9, '0');
  std::int64_t seconds = 0, nanoseconds = 0;
  std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  std::from_chars(fraction.data(), fraction.data() + fraction.size(), nanoseconds);
  return seconds >= kMaxTime_s ? std::nullopt : std::optional(seconds * kSecond_ns + nanoseconds);
}

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

Timestamp parseTime(const std::filesystem::path& file, const TextLine& line) {
  FieldReader fields(file, line);
  const std::string text = trimmed(line.text);
  if (const auto date_ns = dateTime_ns(text)) return {*date_ns};
  if (const auto plain_ns = plainSeconds_ns(text)) return {*plain_ns};
  const double time_s = fields.number("a time in seconds");
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

/// The lines as nanoseconds, where all are whole numbers and they cannot be seconds.
std::optional<std::vector<std::int64_t>> wholeNanoseconds(const std::vector<TextLine>& lines) {
  constexpr std::int64_t kLongest_s = 100'000;  // between two images
  std::vector<std::int64_t> all_ns;
  for (const TextLine& line : lines) {
    std::int64_t value_ns = 0;
    const char* const end = line.text.data() + line.text.size();
    const auto [stop, error] = std::from_chars(line.text.data(), end, value_ns);
    if (error != std::errc() || stop != end || value_ns < 0) return std::nullopt;
    all_ns.push_back(value_ns);
  }
  const bool seconds = all_ns.back() < kMaxTime_s && (all_ns.size() < 2 || all_ns[1] - all_ns[0] < kLongest_s);
  return seconds ? std::nullopt : std::optional(all_ns);
}

}  // namespace

std::vector<Timestamp> readTimestamps(const std::filesystem::path& file) {
  std::vector<Timestamp> stamps;
  for (const TextLine& line : readLines(file)) append(stamps, parseTime(file, line), file, line);
  return stamps;
}

std::vector<Timestamp> parseTimestamps(const std::filesystem::path& file, const std::vector<TextLine>& lines) {
  std::vector<Timestamp> stamps;
  if (lines.empty()) return stamps;
  const auto all_ns = wholeNanoseconds(lines);
  for (std::size_t i = 0; i < lines.size(); ++i)
    append(stamps, all_ns ? Timestamp{(*all_ns)[i]} : parseTime(file, lines[i]), file, lines[i]);
  return stamps;
}

}  // namespace motorcade
