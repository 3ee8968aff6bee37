#pragma once
/// The parts of the simulation, drawn by code: outline, top face, height and taught grasps in millimetres.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/sim/shape.hpp"

namespace pickcell::sim {

enum class Finish { brushed, turned, matt, paper, wood };

/// Something on the top face: print, engraving, or a step in the surface.
struct Mark {
  Shape shape;
  double albedo = 0.2;  ///< of the marked area, 0..1
  double opacity = 1;   ///< 0: only the step shows
  double step_mm = 0;   ///< width of its bevelled edge: > 0 raised, < 0 sunk, 0 flat
};

/// Where a two-finger gripper may take the part. Angle: direction of the tool's X axis in the part's frame, degrees
/// counter-clockwise seen from above.
struct TaughtGrasp {
  double x_mm = 0;
  double y_mm = 0;
  double angle_deg = 0;
  bool sym180 = true;
};

/// One kind of part. Its frame: origin on the top face, x right, y up as drawn, z up; millimetres. Origin and x axis
/// are those of core::Part.
struct PartKind {
  std::string name;
  std::string family;  ///< kinds of one family resemble each other
  Shape outline;       ///< through-holes are cut out
  double height_mm = 10;
  Finish finish = Finish::matt;
  double albedo = 0.5;
  double bevel_mm = 0.8;    ///< width of the broken edge of the outline
  double brush_deg = 0;     ///< direction of the grinding marks
  std::vector<Mark> marks;  ///< later ones over earlier ones
  std::vector<TaughtGrasp> grasps;
  std::uint64_t seed = 1;  ///< of the surface's texture
};

/// Every kind there is, in a fixed order. Built once; thread-safe.
[[nodiscard]] const std::vector<PartKind>& part_catalogue();

/// A kind of the catalogue, or, as "wooden_" or "metal_" before its name, the same part in that material (not part of
/// the catalogue). Unknown names throw std::invalid_argument and name the known ones. Thread-safe.
[[nodiscard]] const PartKind& part_kind(std::string_view name);
/// Whether part_kind() knows the name.
[[nodiscard]] bool is_part_kind(std::string_view name);

}  // namespace pickcell::sim
