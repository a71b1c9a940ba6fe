#include "scenes/fit/fit.h"

#include <algorithm>
#include <cmath>

#include "scenes/content.h"
#include "scenes/error.h"
#include "scenes/fit/baselines.h"
#include "scenes/fit/cover.h"
#include "scenes/fit/difference.h"
#include "scenes/fit/outside_volume.h"
#include "scenes/fit/silhouette.h"
#include "scenes/fit/solid.h"
#include "scenes/log.h"
#include "scenes/storage/cache.h"

namespace penumbra {
namespace {

/// Raise what changes: cached fits are then never looked at.
constexpr int version_of(Objective objective) {
  return objective == Objective::shadow ? 4 : 3;
}

constexpr std::pair<const char*, Objective> names[] = {{"cover", Objective::cover},
                                                       {"shadow", Objective::shadow},
                                                       {"k-means", Objective::k_means},
                                                       {"grid", Objective::grid}};

/// The solid brought to the size of one and to the origin: fits in millimetres and in kilometres are then the same.
struct UnitSolid {
  Mesh mesh;
  vec3 centre;
  float size;

  UnitSolid(Mesh solid, const std::string& what) : mesh(std::move(solid)) {
    const Bounds box = bounds(mesh);
    centre = box.centre();
    size = std::max({box.extent().x, box.extent().y, box.extent().z});
    if (!(size > std::numeric_limits<float>::min() && size < 0.25f * std::numeric_limits<float>::max()))
      throw Error("{}: the mesh is {:.3g} m large, which single precision does not hold; scale it", what, size);
    for (vec3& p : mesh.positions) p = (p - centre) / size;
  }
  /// Coordinates of meshes with few points, which are mostly modelled, go to a lattice: what they round to in another
  /// unit is then the same solid, and has the same fit.
  void snap() {
    if (!has_few_points()) return;
    for (vec3& p : mesh.positions) p = snapped(p, lattice);
  }
  /// A set to start from, for the same reason on a lattice that is coarse enough for its own rounding.
  SphereSet start(SphereSet set) const {
    set = reduced(std::move(set));
    if (has_few_points())
      for (Sphere& s : set.spheres) s = {snapped(s.centre, 0x1p-10f), snapped(vec3(s.radius), 0x1p-10f).x};
    return set;
  }
  SphereSet restored(SphereSet set) const {
    for (Sphere& s : set.spheres) s = {size * s.centre + centre, size * s.radius};
    return set;
  }
  /// The same for balls that must not lose a point of the solid to rounding on the way.
  SphereSet restored_covering(SphereSet set) const {
    const vec3 far = glm::abs(centre) + size;
    const float moved = has_few_points() ? size * lattice : 0.0f;  // by at most 0.87 of it
    const float rounding = 0x1p-21f * std::max({far.x, far.y, far.z}) + moved;
    set = restored(std::move(set));
    for (Sphere& s : set.spheres) s.radius += rounding;
    return set;
  }
  SphereSet reduced(SphereSet set) const {
    for (Sphere& s : set.spheres) s = {(s.centre - centre) / size, s.radius / size};
    return set;
  }

 private:
  static constexpr float lattice = 0x1p-18f;
  bool has_few_points() const { return mesh.positions.size() <= 1000; }
  static vec3 snapped(vec3 p, float step) { return glm::round(p / step) * step; }
};

/// Rows and points grow with the number of spheres: a sphere of the mean volume has a radius of about ten rows.
struct Samples {
  double volume;
  SolidRows rows;
  Samples(const Mesh& solid, int spheres)
      : volume(std::max(enclosed_volume(solid), 1e-3)), rows(solid, cells(solid, spheres)) {}
  double spacing(double points) const { return std::cbrt(volume / points); }

 private:
  double cells(const Mesh& solid, int spheres) const {
    const dvec3 extent = bounds(solid).extent();
    return std::clamp(4000.0 * spheres * extent.x * extent.y * extent.z / volume, 1.5e5, 8e6);
  }
};

SphereSet cover(const Mesh& solid, const FitRequest& request, const std::string& what, const FitProgress& progress) {
  const Samples samples(solid, request.spheres);
  FitPoints points = sample_points(solid, samples.rows, samples.spacing(std::clamp(250.0 * request.spheres, 4e3, 3e4)));
  if (points.size() < request.spheres)
    throw Error("{}: {} spheres asked for, but the mesh only has {} points", what, request.spheres, points.size());
  return cover_solid(solid, samples.rows, std::move(points), request, progress);
}

SphereSet fit_baseline(const Mesh& solid, const FitRequest& request, const std::string& what) {
  const Samples samples(solid, request.spheres);
  if (request.objective == Objective::grid)
    return grid_balls(bounds(solid), sample_points(solid, samples.rows, samples.spacing(1e5)).position,
                      request.spheres);
  const std::vector<vec3> points = interior_points(samples.rows, samples.spacing(1e5));
  if (int(points.size()) < request.spheres)
    throw Error("{}: {} spheres asked for, but only {} points lie inside the mesh", what, request.spheres,
                points.size());
  return k_means_balls(points, request.spheres);
}

std::string fit_key(const Mesh& mesh, const FitRequest& request) {
  ContentHash hash(version_of(request.objective));
  hash.add_value(request.spheres);
  hash.add_value(int(request.objective));
  hash.add_value(request.seed);
  hash.add_value(int(request.assignment));
  add_mesh(hash, mesh);
  return hash.digest();
}

}  // namespace

std::string to_string(Objective objective) {
  for (const auto& [name, value] : names)
    if (value == objective) return name;
  return "";
}

Objective parse_objective(const std::string& name) {
  for (const auto& [known, value] : names)
    if (name == known) return value;
  throw Error("unknown objective '{}'; allowed are {}", name, objective_names);
}

namespace {

/// `start_from` makes the covering set that the objective shadow starts from.
template <class Cover>
SphereSet fit_with(const Mesh& mesh, const FitRequest& request, const std::string& what, const FitProgress& progress,
                   Cover start_from) {
  if (request.spheres < 1 || request.spheres > 4096)
    throw Error("{}: {} spheres asked for; between 1 and 4096 can be fitted", what, request.spheres);
  Repairs repairs;
  UnitSolid solid(make_solid(mesh, what, &repairs), what);
  solid.snap();
  if (repairs.any() && request.objective != Objective::shadow)  // its start has said so
    warn("{}: {}", what, repairs.describe());
  switch (request.objective) {
    case Objective::cover:
      return solid.restored_covering(cover(solid.mesh, request, what, progress));
    case Objective::shadow: {
      FitRequest first = request;
      first.objective = Objective::cover;
      return solid.restored(match_silhouettes(solid.mesh, solid.start(start_from(first)), progress));
    }
    default:
      return solid.restored(fit_baseline(solid.mesh, request, what));
  }
}

}  // namespace

SphereSet fit_spheres(const Mesh& mesh, const FitRequest& request, const std::string& what,
                      const FitProgress& progress) {
  return fit_with(mesh, request, what, progress,
                  [&](const FitRequest& first) { return fit_spheres(mesh, first, what, progress); });
}

namespace {

CacheEntry cache_entry(const Mesh& mesh, const FitRequest& request) {
  return {"fit-" + fit_key(mesh, request) + ".json", "sphere cache", "fitting anew", log_warning};
}

}  // namespace

std::optional<SphereSet> fit_in_cache(const Mesh& mesh, const FitRequest& request) {
  return cache_entry(mesh, request).look_up(load_spheres);
}

SphereSet cached_fit(const Mesh& mesh, const FitRequest& request, const std::string& what,
                     const FitProgress& progress) {
  const auto compute = [&] {
    inform("{}: fitting {} spheres ({}); kept in {}", what, request.spheres, to_string(request.objective),
           cache_folder());
    return fit_with(mesh, request, what, progress,
                    [&](const FitRequest& first) { return cached_fit(mesh, first, what, progress); });
  };
  return cache_entry(mesh, request).get(load_spheres, compute, store_spheres);
}

FitQuality assess_fit(const Mesh& mesh, const SphereSet& set, const std::string& what) {
  const UnitSolid solid(make_solid(mesh, what), what);
  const SphereSet reduced = solid.reduced(set);
  const double unit = std::pow(double(solid.size), 3.0), outside = outside_volume(solid.mesh, reduced);
  const Difference parts = difference(solid.mesh, reduced);
  return {unit * enclosed_volume(solid.mesh), unit * outside, unit * std::max(0.0, outside - parts.shared),
          unit * parts.uncovered};
}

}  // namespace penumbra
