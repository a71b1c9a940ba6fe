// Polygons to triangles.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// Newell's normal: along the right-hand normal of the polygon, as long as twice its area; exact for planar ones.
dvec3 polygon_normal(std::span<const dvec3> corners);

/// Triangles of a simple polygon, convex or not, planar or nearly so, as indices of its corners in its winding: a fan
/// about its first corner (a quadrilateral's reflex one) or, where a fan would leave it, ears clipped (Meisters 1975).
std::vector<std::array<unsigned, 3>> triangulate(std::span<const dvec3> corners);

}  // namespace penumbra
