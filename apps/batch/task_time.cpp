#include "apps/batch/task_time.hpp"

#include <charconv>
#include <string_view>
#include <vector>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

[[noreturn]] void fail(const std::string& text) {
  throw UsageError("--time " + text + ": write minutes, H:MM:SS or D-HH:MM:SS");
}

/// The numbers between the colons.
std::vector<int> numbersIn(std::string_view text, const std::string& whole) {
  constexpr int kMost = 1'000'000;
  std::vector<int> numbers;
  for (std::string_view rest = text;;) {
    const std::string_view digits = rest.substr(0, rest.find(':'));
    int number = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size() || number < 0 || number > kMost) fail(whole);
    numbers.push_back(number);
    if (digits.size() == rest.size()) return numbers;
    rest.remove_prefix(digits.size() + 1);
  }
}

}  // namespace

std::chrono::seconds taskTime(const std::string& text) {
  using namespace std::chrono;
  if (text.empty()) return seconds(0);
  const auto dash = text.find('-');
  const bool with_days = dash != std::string::npos;
  auto numbers = numbersIn(std::string_view(text).substr(with_days ? dash + 1 : 0), text);
  if (numbers.size() > 3) fail(text);
  seconds total(0);
  if (with_days) {
    total += hours(24 * numbersIn(std::string_view(text).substr(0, dash), text).front());
    numbers.resize(3, 0);
  } else if (numbers.size() < 3) {  // minutes, with seconds or without
    numbers.insert(numbers.begin(), 0);
    numbers.resize(3, 0);
  }
  total += hours(numbers[0]) + minutes(numbers[1]) + seconds(numbers[2]);
  if (total <= seconds(0)) fail(text);
  return total;
}

}  // namespace motorcade
