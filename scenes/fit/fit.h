// Spheres in place of a mesh: fits of a given number of them (docs/sphere-fits.md).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scenes/sphere_set.h"

namespace penumbra {

/// cover:   every point of the solid is in a sphere, with least volume outside it (Wang et al. 2006)
/// shadow:  silhouettes, and so shadows, come nearest to the mesh's; nothing need be covered
/// k_means: baseline: clusters of inside points, each with the ball that reaches its farthest member
/// grid:    baseline: balls around the cells of a cubic lattice that the solid meets
enum class Objective { cover, shadow, k_means, grid };
inline constexpr const char* objective_names = "cover, shadow, k-means, grid";
std::string to_string(Objective objective);
/// Throws Error listing the names.
Objective parse_objective(const std::string& name);

/// How `cover` gives points to balls.
/// nearest: to the ball whose outside volume is least when it reaches from zero radius to the point
/// flood:   as published: one after the other by a flood fill, to the ball that grows most cheaply from its radius then
enum class Assignment { nearest, flood };

struct FitRequest {
  int spheres = 64;
  Objective objective = Objective::shadow;
  std::uint64_t seed = 1;
  Assignment assignment = Assignment::nearest;
};

/// What a set of spheres is worth. Volumes in cubic metres.
struct FitQuality {
  double volume = 0.0;     ///< of the solid
  double outside = 0.0;    ///< sum over spheres of what lies outside the solid; shared parts count for each sphere
  double excess = 0.0;     ///< of the union of spheres outside the solid
  double uncovered = 0.0;  ///< of the solid outside the union of spheres
  double coverage() const { return volume > 0.0 ? 1.0 - uncovered / volume : 1.0; }
};

using FitProgress = std::function<void(const std::string& stage, double share)>;

/// Fits spheres to a closed mesh. The same bits for any number of threads. The mesh is repaired where that is safe
/// (make_solid). Throws Error naming `what` if the mesh is not closed, if no or more than 4096 spheres are asked for,
/// or more than it has points. May return fewer spheres where fewer cover it as well.
SphereSet fit_spheres(const Mesh& mesh, const FitRequest& request, const std::string& what = "sphere fit",
                      const FitProgress& progress = {});

/// What fit_spheres() returns, from the cache folder if it holds it; computed and stored there otherwise.
SphereSet cached_fit(const Mesh& mesh, const FitRequest& request, const std::string& what,
                     const FitProgress& progress = {});

/// A fit that the cache folder holds, or nothing: nothing is fitted.
std::optional<SphereSet> fit_in_cache(const Mesh& mesh, const FitRequest& request);

/// `volume` and `outside` by triangles of the union's surface, exactly; what spheres share outside, and so `excess`,
/// and `uncovered` over rows (difference): within about 1e-3 of the solid's volume. Never more excess than outside.
FitQuality assess_fit(const Mesh& mesh, const SphereSet& set, const std::string& what = "sphere fit");

}  // namespace penumbra
