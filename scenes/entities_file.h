// The parts of a scene file that say what blocks light: [occluder], or one [[entity]] for each thing; and what moves.
#pragma once

#include "scenes/scene.h"
#include "scenes/scene_file.h"
#include "scenes/toml_reader.h"

namespace penumbra {

/// What the spheres of several entities are fitted for: the same, "mixed", or nothing.
class JoinedObjective {
 public:
  /// Of one entity with spheres; empty where they are given.
  void add(const std::string& objective) { joined_ = !joined_ || *joined_ == objective ? objective : "mixed"; }
  std::string name() const { return joined_.value_or(""); }

 private:
  std::optional<std::string> joined_;
};

/// All entities, in the scene's coordinates and in double: they are narrowed once the receivers say where.
struct EntityList {
  ImportedMesh mesh;
  SphereList spheres;
  JoinedObjective objective;
  std::vector<Entity> entities;
  std::vector<std::optional<TomlReader>> motions;  ///< of each, to be read once the origin is known
};

/// How many spheres, and for what, each of the tables gets of what a suite chooses: a count is for all of them
/// together, in even shares; one without a mesh keeps what it has, if it is not alone.
std::vector<SphereChoice> choices_of(std::vector<TomlReader>& entities, const SphereChoice& choice);

EntityList read_entities(TomlReader& file, const SphereChoice& choice, const FitProgress& progress);

/// Gives every entity its own motion, if it has one.
void read_motions_of_entities(EntityList& list, dvec3 origin);

/// [motion].
Motion read_motion(TomlReader at, dvec3 origin);

}  // namespace penumbra
