// What a reader of one format finds, and the one way from there to a mesh.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scenes/import/guard.h"
#include "scenes/import/import.h"

namespace penumbra {

inline constexpr unsigned no_normal = std::numeric_limits<unsigned>::max();

struct Corner {
  unsigned position, normal = no_normal;
};

struct RawTriangle {
  std::array<Corner, 3> corners;
  bool file_normals = false;  ///< the file gives them, so that they tell which side is outside
};

/// Triangles as a reader finds them: positions may repeat, lie unused, or be no numbers.
struct RawMesh {
  std::vector<dvec3> positions;
  std::vector<dvec3> normals;  ///< of any length; zero or not finite: not given
  std::vector<RawTriangle> triangles;
  bool facets = false;  ///< normals are of single triangles, as in STL: they repeat the winding, often wrongly
  /// Distance of neighbouring numbers where the coordinates are largest, in units of the file, if they come in single
  /// precision; 0 if not.
  double spacing = 0.0;

  /// Adds the triangles of a polygon; fewer than three corners are points and lines, and left out. `mirrored` turns
  /// the winding around. Every position must be there already.
  void add_polygon(std::span<const Corner> corners, bool file_normals, bool mirrored = false);
  /// Gives one triangle its own normal.
  void make_flat(RawTriangle& triangle);
};

/// Distance of neighbouring single-precision numbers at the largest coordinate.
double float_spacing(std::span<const dvec3> positions);

/// A normal of any length at length 1; zero and infinite ones mean nothing and become zero.
dvec3 unit_or_zero(dvec3 normal);

/// For each position, the number of the first equal one (0 and -0 are equal).
std::vector<unsigned> equal_places(const std::vector<dvec3>& positions);

/// Turns around what is wound against the file's normals (turn.h), joins corners of equal position and normal in the
/// order of first use, and drops triangles with two corners in one place and what belongs to no triangle. `says` gets a
/// line about what was turned and about lost precision. Throws Error naming `path` if no triangle is left or a vertex
/// of one is not finite.
ImportedMesh assemble(RawMesh raw, const std::string& path, Outbox& says);

}  // namespace penumbra
