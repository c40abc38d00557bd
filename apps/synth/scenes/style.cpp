#include "apps/synth/scenes/style.hpp"

#include <array>
#include <stdexcept>

namespace motorcade::synth {
namespace {

struct Named {
  const char* name;
  Style style;
};
constexpr std::array kStyles = std::to_array<Named>({{"plain", Style::kPlain}, {"film", Style::kFilm}});

}  // namespace

std::vector<std::string> styleNames() {
  std::vector<std::string> names;
  for (const auto& entry : kStyles) names.emplace_back(entry.name);
  return names;
}

Style styleOf(const std::string& name) {
  std::string known;
  for (const auto& entry : kStyles) {
    if (name == entry.name) return entry.style;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown style '" + name + "': there are " + known);
}

}  // namespace motorcade::synth
