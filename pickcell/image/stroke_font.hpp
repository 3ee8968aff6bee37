#pragma once
/// A plotter's letters: every printable ASCII character as strokes on a grid.

#include <vector>

#include "pickcell/image/draw.hpp"

namespace pickcell::image::stroke_font {

constexpr double kCapitalHeight = 6;  ///< units from the top of a capital to the line it stands on
constexpr double kAdvance = 6;        ///< units from one character to the next

/// Appends the strokes of c; unit: pixels per grid unit.
void add_glyph(char c, Point top_left, double unit, std::vector<Path>& strokes);

}  // namespace pickcell::image::stroke_font
