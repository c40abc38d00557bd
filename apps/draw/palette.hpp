#pragma once

#include <cstddef>

#include "apps/canvas/color.hpp"
#include "core/ids.hpp"

/// The colors of pictures.
namespace motorcade {

inline constexpr Color kBackdrop{14, 18, 24}, kBar{22, 28, 36}, kGridLine{44, 53, 64}, kDark{10, 13, 18},
    kInk{232, 237, 243}, kDimInk{146, 158, 172}, kTruth{245, 245, 245}, kOwn{126, 172, 255};

/// Colors of tracks, the same in every picture and on every page. None is blue, which is the camera's own, nor looks
/// like it to people who see no red or no green. To them, the colors of consecutive tracks differ, too.
inline constexpr std::size_t kTrackColors = 10;
Color trackColor(TrackId track);

}  // namespace motorcade
