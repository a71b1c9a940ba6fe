// What scenes consist of, as parts of a content key (scenes/storage/content_key.h).
#pragma once

#include "scenes/mesh.h"
#include "scenes/storage/content_key.h"

namespace penumbra {

inline void add_vec(ContentHash& hash, vec3 v) {
  for (int c = 0; c < 3; ++c) hash.add_value(v[c]);
}

inline void add_mesh(ContentHash& hash, const Mesh& mesh) {
  hash.add(mesh.positions), hash.add(mesh.triangles);
}

}  // namespace penumbra
