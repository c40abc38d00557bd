#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace motorcade {

/// A number that names one kind of thing and cannot be mistaken for another kind.
template <class Tag>
struct Id {
  std::int64_t value = -1;
  // NOLINTNEXTLINE(modernize-use-nullptr): the check misreads the comparison that the compiler writes
  constexpr auto operator<=>(const Id&) const = default;
  constexpr bool valid() const { return value >= 0; }
};

/// Index of a stereo pair in its sequence: the line number of the run folder's files.
using FrameId = Id<struct FrameTag>;
/// A scene point that optical flow follows over several frames. Never used twice in one run.
using PointId = Id<struct PointTag>;
/// A moving object that the tracker follows. Never used twice in one run.
using TrackId = Id<struct TrackTag>;

}  // namespace motorcade

template <class Tag>
struct std::hash<motorcade::Id<Tag>> {
  std::size_t operator()(const motorcade::Id<Tag>& id) const noexcept { return std::hash<std::int64_t>{}(id.value); }
};
