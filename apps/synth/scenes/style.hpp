#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace motorcade::synth {

/// Textures, lens and sensor with which a scene is pictured. Geometry and truth are the same in all styles.
enum class Style : std::uint8_t {
  kPlain,
  kFilm,  // veined textures of less contrast, a soft lens with vignette, wandering exposure, grain
};

std::vector<std::string> styleNames();
/// Throws std::invalid_argument, naming the styles there are, for an unknown name.
Style styleOf(const std::string& name);

}  // namespace motorcade::synth
