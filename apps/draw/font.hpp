#pragma once

namespace motorcade {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 9;

/// Whether a pixel of a letter is set: five columns, seven rows above the base line and two below. A character that is
/// not printable is blank.
bool glyphPixel(char letter, int x, int y);

}  // namespace motorcade
