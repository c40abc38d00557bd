#include "apps/draw/palette.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace motorcade {

Color trackColor(TrackId track) {
  constexpr std::array<Color, 10> kColors{{{255, 176, 32},
                                           {64, 196, 255},
                                           {124, 220, 92},
                                           {255, 105, 140},
                                           {186, 138, 255},
                                           {255, 224, 82},
                                           {64, 224, 190},
                                           {255, 138, 80},
                                           {140, 170, 255},
                                           {230, 130, 230}}};
  return kColors[std::max<std::int64_t>(track.value, 0) % kColors.size()];
}

}  // namespace motorcade
