// Orientation by a file's normals.
#pragma once

#include "scenes/import/raw_mesh.h"

namespace penumbra {

/// Turns triangles around that are wound against the normals that the file gives: as a whole what hangs together by
/// edges along which the winding agrees, by vote of area, so that a closed surface stays closed. Where the normals are
/// of facets, and so say again what the winding says, a surface that encloses its volume is left as it is, and all
/// become flat. `place` numbers positions by equality; `says` gets a line about what was turned.
void turn_to_normals(RawMesh& mesh, const std::vector<unsigned>& place, const std::string& path, Outbox& says);

}  // namespace penumbra
