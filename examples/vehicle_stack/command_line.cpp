#include "command_line.hpp"

#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace vehicle_stack {

const char* const kUsageText =
    "usage: vehicle_stack DRIVE [OPTION VALUE]...\n"
    "  camera    --rate HZ (30) --loops N (1) --pairs N (300, of the drive, in memory) --stamps kept|remade (kept)\n"
    "            --stall-at S --stall-for S (no stall)\n"
    "  mounting  --x M (0) --y M (0) --height M (1.65) --roll DEG --pitch DEG (positive: down) --yaw DEG (0)\n"
    "  trust     --margin FACTOR (2, of standard deviations)\n"
    "  tracker   --threads N (2) --priority N (0; 1 to 99: SCHED_FIFO) --cpus 0,1 (all)\n";

namespace {

struct Range {
  double least, most;
};

template <class Number>
Number numberOf(const std::string& option, std::string_view value, Range range) {
  Number number{};
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size() || !(number >= range.least && number <= range.most))
    throw UsageError(option + ": takes a number from " + std::to_string(range.least) + " to " +
                     std::to_string(range.most) + ", not '" + std::string(value) + "'");
  return number;
}

std::vector<int> listOf(const std::string& option, std::string_view value) {
  std::vector<int> numbers;
  for (std::size_t begin = 0; begin <= value.size();) {
    const std::size_t end = std::min(value.find(',', begin), value.size());
    numbers.push_back(numberOf<int>(option, value.substr(begin, end - begin), {0, 1023}));
    begin = end + 1;
  }
  return numbers;
}

FolderCamera::Stamps stampsOf(const std::string& value) {
  if (value == "kept") return FolderCamera::Stamps::kKept;
  if (value == "remade") return FolderCamera::Stamps::kRemade;
  throw UsageError("--stamps: takes kept or remade, not '" + value + "'");
}

using Setters = std::map<std::string, std::function<void(const std::string& option, const std::string& value)>>;

Setters settersOf(CommandLine& line) {
  const auto number = [](auto& field, Range range) {
    return [&field, range](const std::string& option, const std::string& value) {
      field = numberOf<std::remove_reference_t<decltype(field)>>(option, value, range);
    };
  };
  const auto degrees = [](double& field_rad) {
    return [&field_rad](const std::string& option, const std::string& value) {
      field_rad = numberOf<double>(option, value, {-180, 180}) * std::numbers::pi / 180;
    };
  };
  constexpr Range kPlace_m{-20, 20}, kTime_s{0, 1e6};
  return {{"--rate", number(line.camera.rate_hz, {0.1, 1000})},
          {"--loops", number(line.camera.loops, {1, 1e6})},
          {"--pairs", number(line.camera.most_pairs, {1, 1e6})},
          {"--stamps", [&](const auto&, const std::string& value) { line.camera.stamps = stampsOf(value); }},
          {"--stall-at", number(line.camera.stall_at_s, kTime_s)},
          {"--stall-for", number(line.camera.stall_for_s, kTime_s)},
          {"--x", number(line.mounting.x_m, kPlace_m)},
          {"--y", number(line.mounting.y_m, kPlace_m)},
          {"--height", number(line.mounting.z_m, kPlace_m)},
          {"--roll", degrees(line.mounting.roll_rad)},
          {"--pitch", degrees(line.mounting.pitch_rad)},
          {"--yaw", degrees(line.mounting.yaw_rad)},
          {"--margin", number(line.margin, {1, 100})},
          {"--threads", number(line.tracker.threads, {1, 64})},
          {"--priority", number(line.tracker.realtime_priority, {0, 99})},
          {"--cpus", [&](const auto& option, const std::string& value) { line.tracker.cpus = listOf(option, value); }}};
}

}  // namespace

CommandLine parsed(int argc, const char* const* argv) {
  CommandLine line;
  const Setters setters = settersOf(line);
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto setter = setters.find(word);
    if (setter != setters.end()) {
      if (++i == argc) throw UsageError(word + ": its value is missing");
      setter->second(word, argv[i]);
    } else if (word.starts_with("--") || !line.drive.empty()) {
      throw UsageError(word + ": is no option");
    } else {
      line.drive = word;
    }
  }
  if (line.drive.empty()) throw UsageError("DRIVE: the folder of a recorded drive is missing");
  return line;
}

}  // namespace vehicle_stack
