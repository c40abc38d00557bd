#include "apps/inject/fault_spec.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <random>
#include <sstream>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

/// Name and range of values of a kind; a kind without a value has an empty range.
struct KindEntry {
  FaultKind kind;
  std::string_view name;
  double fallback, least, most;
  std::string_view meaning;
  bool of_images = false;  // and so of one or both sides
  bool hasValue() const { return least < most; }
};

constexpr std::array kKinds{
    KindEntry{FaultKind::kDrop, "drop", 0, 0, 0, "the pair never comes"},
    KindEntry{FaultKind::kDuplicate, "duplicate", 0, 0, 0, "it has the images of the pair before"},
    KindEntry{FaultKind::kLate, "late", 1, 1, 100, "it comes so many pairs later"},
    KindEntry{FaultKind::kLate, "reordered", 1, 0, 0, "it changes places with the next"},
    KindEntry{FaultKind::kBlack, "black", 0, 0, 0, "black images", true},
    KindEntry{FaultKind::kWhite, "white", 0, 0, 0, "white images", true},
    KindEntry{FaultKind::kBlur, "blur", 9, 1, 99, "blurred over so many pixels", true},
    KindEntry{FaultKind::kNoise, "noise", 20, 0, 255, "noise of so many gray levels", true},
    KindEntry{FaultKind::kExposure, "exposure", 0.5, 0.01, 100, "gray levels times so much", true},
    KindEntry{FaultKind::kJpeg, "jpeg", 10, 1, 100, "compressed at this quality", true},
    KindEntry{FaultKind::kTruncated, "truncated", 0.5, 0, 1, "only this share of the file is there", true},
    KindEntry{FaultKind::kBitFlips, "bitflips", 10, 1, 1e6, "so many bits of the file are wrong", true},
    KindEntry{FaultKind::kExchanged, "exchanged", 0, 0, 0, "left is right"},
    KindEntry{FaultKind::kApart, "apart", 1, 1, 100, "the right image is that of so many pairs before"},
    KindEntry{FaultKind::kLowered, "lowered", 4, -100, 100, "the content is so many rows lower", true},
    KindEntry{FaultKind::kRolled, "rolled", 1, -45, 45, "turned clockwise by so many degrees", true},
    KindEntry{FaultKind::kZoomed, "zoomed", 1, -50, 50, "larger by so many percent", true},
    KindEntry{FaultKind::kBarrel, "barrel", -0.1, -0.5, 0.5, "distorted: k1, with half the width as the unit", true},
    KindEntry{FaultKind::kOneEyed, "one_eyed", 0, 0, 0, "one image does not come, the right one unless named", true},
    KindEntry{FaultKind::kStall, "stall", 1, 0, 3600, "nothing comes for so many seconds"},
    KindEntry{FaultKind::kTimeJump, "jump", 3600, -1e9, 1e9,
              "times are so many seconds later from here on, or earlier"},
    KindEntry{FaultKind::kOutOfMemory, "memory", 16, 0, 1e6, "from here on only so many more megabytes"},
    KindEntry{FaultKind::kDiskFull, "disk", 16, 0, 1e9, "from here on no file grows beyond so many kilobytes"},
    KindEntry{FaultKind::kDiskStall, "disk_stall", 1.5, 0, 3600, "the disk takes its results so many seconds later"}};

[[noreturn]] void fail(std::string_view part, const std::string& why) {
  throw UsageError("--inject " + std::string(part) + ": " + why);
}

/// Returns the text after the last `mark` and cuts `text` there. Empty when the mark is not in it.
std::optional<std::string_view> cutAt(std::string_view& text, char mark) {
  const auto at = text.rfind(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view after = text.substr(at + 1);
  text = text.substr(0, at);
  return after;
}

double numberIn(std::string_view part, std::string_view text, double least, double most) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= least && value <= most)) {
    std::ostringstream why;
    why << text << " is no number from " << least << " to " << most;
    fail(part, why.str());
  }
  return value;
}

/// A, A:B or A:B:STEP.
void readFrames(std::string_view part, std::string_view text, Fault& fault) {
  constexpr double kMostFrames = 1e9;
  std::string range(text);
  if (std::ranges::count(text, ':') == 2) {
    fault.step = static_cast<std::size_t>(numberIn(part, text.substr(text.rfind(':') + 1), 1, kMostFrames));
    range.resize(text.rfind(':'));
  } else if (std::ranges::count(text, ':') == 0) {
    const auto frame = static_cast<std::size_t>(numberIn(part, text, 0, kMostFrames));
    fault.frames = {frame, frame + 1};
    return;
  }
  try {
    if (range != ":") fault.frames = parseFrameRange(range);
  } catch (const UsageError& error) {
    fail(part, error.what());
  }
}

const KindEntry& kindOf(std::string_view part, std::string_view name) {
  const auto entry = std::ranges::find(kKinds, name, &KindEntry::name);
  if (entry == kKinds.end()) fail(part, std::string(name) + " is no fault; these are:\n" + faultHelp());
  return *entry;
}

Fault parseFault(const std::string_view part) {
  Fault fault;
  std::string_view rest = part;
  if (const auto share = cutAt(rest, '~')) fault.share = numberIn(part, *share, 0, 1);
  if (const auto frames = cutAt(rest, '@')) readFrames(part, *frames, fault);
  const auto side = cutAt(rest, '/');
  if (side && *side != "left" && *side != "right") fail(part, "write /left or /right");
  if (side) fault.side = *side == "left" ? FaultSide::kLeft : FaultSide::kRight;
  const auto value = cutAt(rest, '=');
  const KindEntry& entry = kindOf(part, rest);
  if (value && !entry.hasValue()) fail(part, std::string(entry.name) + " takes no value");
  if (side && !entry.of_images) fail(part, std::string(entry.name) + " is of the pair, not of one image");
  fault.kind = entry.kind;
  fault.value = value ? numberIn(part, *value, entry.least, entry.most) : entry.fallback;
  if (fault.kind == FaultKind::kOneEyed && !side) fault.side = FaultSide::kRight;
  return fault;
}

}  // namespace

FaultSpec parseFaultSpec(std::string_view text) {
  constexpr std::string_view kSeed = "seed=";
  constexpr double kMostSeed = 1e15;  // integers up to here are exact
  FaultSpec spec;
  while (!text.empty()) {
    const auto comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    if (part.starts_with(kSeed))
      spec.seed = static_cast<std::uint64_t>(numberIn(part, part.substr(kSeed.size()), 0, kMostSeed));
    else
      spec.faults.push_back(parseFault(part));
  }
  return spec;
}

std::string faultHelp() {
  std::ostringstream help;
  for (const KindEntry& entry : kKinds) {
    help << "  " << entry.name;
    if (entry.hasValue()) help << '=' << entry.fallback;
    help << ": " << entry.meaning << '\n';
  }
  return help.str();
}

std::uint64_t seedOf(std::uint64_t seed, std::size_t index_of_fault, FrameId frame) {
  std::seed_seq mixed{seed, static_cast<std::uint64_t>(index_of_fault), static_cast<std::uint64_t>(frame.value)};
  std::array<std::uint32_t, 2> words{};
  mixed.generate(words.begin(), words.end());
  return std::uint64_t{words[0]} << 32 | words[1];
}

bool strikes(const Fault& fault, std::size_t index_of_fault, FrameId frame, std::uint64_t seed) {
  const auto index = static_cast<std::size_t>(frame.value);
  if (index < fault.frames.begin || index >= fault.frames.end) return false;
  if ((index - fault.frames.begin) % fault.step != 0) return false;
  if (fault.share >= 1) return true;
  std::mt19937_64 random(seedOf(seed, index_of_fault, frame));
  return std::uniform_real_distribution<double>(0, 1)(random) < fault.share;
}

double diskStall_s(const FaultSpec& spec, FrameId frame) {
  double stall_s = 0;
  for (std::size_t k = 0; k < spec.faults.size(); ++k)
    if (spec.faults[k].kind == FaultKind::kDiskStall && strikes(spec.faults[k], k, frame, spec.seed))
      stall_s += spec.faults[k].value;
  return stall_s;
}

}  // namespace motorcade
