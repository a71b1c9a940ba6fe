// The parts of a scene file that say what blocks light: [occluder], or one [[entity]] for each thing; and what moves.
#pragma once

#include "scenes/scene.h"
#include "scenes/scene_file.h"
#include "scenes/toml_reader.h"

namespace penumbra {

/// All entities, in the scene's coordinates and in double: they are narrowed once the receivers say where.
struct EntityList {
  ImportedMesh mesh;
  SphereList spheres;
  std::string objective;  ///< that spheres were fitted for; empty if all are given
  std::vector<Entity> entities;
  std::vector<std::optional<TomlReader>> motions;  ///< of each, to be read once the origin is known
};

EntityList read_entities(TomlReader& file, const SphereChoice& choice, const FitProgress& progress);

/// Gives every entity its own motion, if it has one.
void read_motions_of_entities(EntityList& list, dvec3 origin);

/// [motion].
Motion read_motion(TomlReader at, dvec3 origin);

}  // namespace penumbra
