// Receivers grouped by their normals: what is prepared for a group serves all of its receivers, however many normals a
// picture has.
//
// A normal that many receivers share (a plane's, a box's) is a group of its own. The others fall into the 6 x 8 x 8
// cells of a cube, about 11 degrees wide; a cell's cone bounds the normals in it.
#pragma once

#include <cstdint>
#include <vector>

#include "techniques/bases/cap.h"

namespace penumbra {

/// Does a group's cone hold one normal, its axis?
inline bool one_normal(const Cone& cone) {
  return cone.sine == 0.0f;
}

struct NormalTable {
  std::vector<Cone> cones;           ///< per group: bounds its normals
  std::vector<std::uint16_t> index;  ///< per receiver: its group; 0 where the normal is zero

  /// Groups in the order in which receivers first meet them, single ones first. Every distinct normal is a group if
  /// there are up to 8; else those of an eighth of the receivers or more are.
  static NormalTable of(const std::vector<vec3>& normals);
};

}  // namespace penumbra
