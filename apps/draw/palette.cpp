#include "apps/draw/palette.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace motorcade {

Color trackColor(TrackId track) {
  constexpr std::array<Color, kTrackColors> kColors{{{255, 176, 32},
                                                     {96, 216, 110},
                                                     {255, 96, 150},
                                                     {250, 232, 120},
                                                     {236, 104, 40},
                                                     {56, 204, 170},
                                                     {196, 134, 92},
                                                     {178, 236, 72},
                                                     {240, 190, 184},
                                                     {214, 70, 150}}};
  return kColors[std::max<std::int64_t>(track.value, 0) % kTrackColors];
}

}  // namespace motorcade
