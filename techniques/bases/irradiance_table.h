// What an environment sends to surfaces of whatever normal, without any occluder: E(N) / pi = 1/pi integral of
// L max(0, N.w) dw, tabulated over normals and interpolated between them.
//
// The sphere is cut into blocks, each kept as its vector M = integral of L w dw: a block above the horizon gives
// exactly N.M, one below nothing, and of those that the horizon cuts only the cut ones are rounded, to max(0, N.M): by
// some rho^2 / 4 of their light for blocks of angular radius rho. Nodes lie on the faces of a cube; E is as smooth as a
// clamped cosine, so linear interpolation over 3 degrees costs some 10^-4.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "scenes/environment.h"

namespace penumbra {

class IrradianceTable {
 public:
  IrradianceTable() = default;
  /// Fills the nodes that the receivers' normals ask for; zero normals ask for none.
  IrradianceTable(const Environment& environment, std::span<const vec3> normals);

  /// Reflected radiance at albedo 1, of a normal that was asked for or lies between such.
  vec3 at(vec3 normal) const;

  /// Solid angle, sr, that the same light would fill evenly: (integral of L)^2 / integral of L^2 by luminance, in
  /// blocks; 0 of a black environment. From a few blocks for a sun to 4 pi for an even sky.
  double effective_solid_angle() const { return solid_angle_; }

  std::size_t bytes() const { return nodes_.size() * sizeof(vec3); }

 private:
  static constexpr int edge = 32;  ///< cells along an edge of a face
  struct Cell {
    int node;    ///< its first; the others lie beside and below
    float s, t;  ///< place in the cell, [0, 1]
  };
  static Cell cell_of(vec3 normal);

  double solid_angle_ = 0.0;
  std::vector<vec3> nodes_;  ///< per face (edge + 1)^2
};

}  // namespace penumbra
