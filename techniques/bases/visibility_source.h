// Where blocked texels come from: shared by every technique that integrates over a 6 x n x n bit cube.
#pragma once

#include <optional>

#include "techniques/bases/blocked.h"
#include "techniques/registry.h"

namespace penumbra {

/// rays:   the mesh, one ray per texel centre
/// raster: the sphere set, exact caps
/// table:  the sphere set through the precomputed table of Zhao & Che 2011
/// fine:   the same through a table of more directions and radii in as much memory
class VisibilitySource {
 public:
  /// "visibility", "resolution" and "bins", for the declarations of techniques.
  static std::vector<Parameter> parameters();
  static std::vector<Knob> knobs();
  static bool reads_spheres(const Parameters& parameters) { return parameters.text("visibility") != "rays"; }

  /// Throws Error if the parameters exclude each other.
  VisibilitySource(const Parameters& parameters, const std::string& owner);

  /// Throws Unsupported if the scene has no spheres but they are needed.
  void prepare(const Scene& scene);
  void update(const Frame& frame);

  int resolution() const { return n_; }
  bool traces_rays() const { return kind_ == Kind::rays; }
  const std::vector<vec3>& directions() const { return directions_; }
  const LineCones& cones() const { return cones_; }
  const SphereSet& spheres() const { return *spheres_; }

  /// Blocked texels of a receiver, one sphere or ray after the other: the oracle.
  void find_blocked(int receiver, BitCube& blocked) const;
  /// What the vectorised search needs; stays valid until the next update.
  BlockedJob job() const;

  Footprint footprint() const;

 private:
  enum class Kind { rays, raster, table };
  Kind kind_;
  int n_;
  SphereTable::Shape shape_;
  std::vector<vec3> directions_;
  LineCones cones_;
  std::optional<SphereTable> table_;
  RayScene rays_;
  SphereLanes lanes_;
  std::vector<int> order_;
  const Receivers* receivers_ = nullptr;
  const SphereSet* spheres_ = nullptr;
};

}  // namespace penumbra
