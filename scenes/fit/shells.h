// Which way the shells of a mesh face: as the file means it where it says so, and repaired where it does not.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scenes/mesh.h"

namespace penumbra {

/// Triangles connected through edges of two, which agree on their sides.
struct Patch {
  std::vector<unsigned> triangles;
  bool as_given;  ///< the file turned them all alike
};

using Edge = std::pair<unsigned, unsigned>;               ///< two vertices, the lower one first
using Junctions = std::map<Edge, std::vector<unsigned>>;  ///< edges of more than two triangles, and those triangles

/// Turns patches so that at every edge as many triangles leave as arrive, the outermost shells face outward, and a
/// shell inside another one is a cavity if the file turns it the other way, part of the solid if the same way. Where
/// the file contradicts itself a shell inside an odd number of others is a cavity, and patches that meet at an edge
/// enclose what an odd number of them surrounds. Only swaps second and third corners. Throws Error naming `what` and
/// the edge if no orientation fits.
void orient_shells(Mesh& mesh, std::vector<Patch> patches, Junctions junctions, const std::string& what);

/// Volume that the triangles enclose, cubic metres; negative if they face inward.
double signed_volume(const Mesh& mesh, const std::vector<unsigned>& triangles);

}  // namespace penumbra
