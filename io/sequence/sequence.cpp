#include "io/sequence/sequence.hpp"

#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "io/files/errors.hpp"

namespace motorcade {

FrameRange parseFrameRange(std::string_view text) {
  const auto colon = text.find(':');
  const auto bad = [&] {
    return UsageError("--frames " + std::string(text) + ": write A:B, the first frame and the one after the last");
  };
  if (colon == std::string_view::npos) throw bad();
  const auto parse = [&](std::string_view part, std::size_t when_empty) {
    if (part.empty()) return when_empty;
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) throw bad();
    return value;
  };
  const FrameRange everything;
  const FrameRange range{parse(text.substr(0, colon), everything.begin), parse(text.substr(colon + 1), everything.end)};
  if (range.size() == 0) throw bad();
  return range;
}

FrameRange selectedFrames(std::string_view text, const Sequence& sequence) {
  const FrameRange range = (text.empty() ? FrameRange{} : parseFrameRange(text)).within(sequence.frames.size());
  if (range.size() == 0)
    throw UsageError("--frames " + std::string(text) + ": the sequence has " + std::to_string(sequence.frames.size()) +
                     " frames, none of these");
  return range;
}

}  // namespace motorcade
