// Orientation by a file's normals.
#pragma once

#include "scenes/import/raw_mesh.h"

namespace penumbra {

/// Turns triangles of `mesh` around that are wound against the normals that the file gave for them. `raw` holds the
/// same triangles, `place` numbers their positions by equality. See assemble().
void turn_to_normals(ImportedMesh& mesh, const std::vector<RawTriangle>& raw, const std::vector<unsigned>& place,
                     const std::string& path, Outbox& says);

}  // namespace penumbra
