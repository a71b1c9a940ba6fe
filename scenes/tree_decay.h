// When a tree over a mesh that moves is to be built anew rather than refitted (Lauterbach et al. 2006).
//
// A refitted tree keeps together what lay together when it was built. If that drifts apart, boxes grow, and rays enter
// more of them than they need to: in proportion to their surface. Embree does not tell its boxes, so the measure is
// taken of boxes like them: those of 32 neighbouring triangles each. Their surface, over that of the whole mesh's box,
// may grow by half.
#pragma once

#include <vector>

#include "scenes/mesh.h"

namespace penumbra {

class TreeDecay {
 public:
  TreeDecay() = default;
  /// Of the mesh that the tree is built over.
  explicit TreeDecay(const Mesh& mesh);

  bool same_triangles(const Mesh& mesh) const;
  /// The measure now over that when the tree was built. The mesh has the same triangles.
  double growth(const Mesh& mesh) const { return surface(mesh) / built_; }
  bool has_decayed(const Mesh& mesh) const { return !(growth(mesh) <= 1.5); }

  std::size_t bytes() const { return triangles_.size() * (sizeof(uvec3) + sizeof(std::uint32_t)); }

 private:
  double surface(const Mesh& mesh) const;

  std::vector<uvec3> triangles_;
  std::vector<std::uint32_t> order_;  ///< triangles, neighbours one after the other
  double built_ = 1.0;
};

}  // namespace penumbra
