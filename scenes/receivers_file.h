// The parts of a scene file that say what is shaded: [receivers] and [[mirror]].
#pragma once

#include "scenes/scene.h"
#include "scenes/toml_reader.h"

namespace penumbra {

/// [receivers]; sets the place that the scene's coordinates are counted from.
ReceiverSpec read_receivers(TomlReader at, const ImportedMesh& mesh, dvec3& origin);

/// Every [[mirror]] of the file.
std::vector<Mirror> read_mirrors(TomlReader& file, dvec3 origin);

/// Throws Error where the scene's mirrors cannot be what the file says. A mirror's shadow joins the mesh, and no
/// spheres stand for it.
void check_mirrors(TomlReader& file, const Scene& scene, bool has_spheres);

}  // namespace penumbra
