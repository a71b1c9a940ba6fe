#include "scenes/receivers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/ray_origins.h"

namespace penumbra {

namespace {

void warn_of_large_triangles(const Receivers& r) {
  vec3 low(std::numeric_limits<float>::infinity()), high = -low;
  float most = 0.0f;
  for (int i = 0; i < r.size(); ++i) {
    if (!r.valid(i)) continue;
    low = glm::min(low, r.position[i]), high = glm::max(high, r.position[i]);
    most = std::max(most, glm::distance(r.origin[i], r.position[i]));
  }
  if (most > 1e-3f * glm::distance(low, high) && r.size() > 1)
    warn(
        "receivers lie on triangles so large that their rays must start {:.2g} m above them, {:.2g} % of what is "
        "looked "
        "at: divide the largest triangles of the mesh, or let the largest mirrors cast no shadow",
        most, 100.0f * most / glm::distance(low, high));
}

}  // namespace

void place_ray_origins(Receivers& r, const std::vector<vec3>& side, const Mesh& mesh, const RayScene& rays) {
  const RayOrigins origins(mesh, rays);
  r.origin = r.position;
  r.touches.assign(r.position.size(), 0);
  tbb::parallel_for(tbb::blocked_range<int>(0, r.size(), 256), [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i < range.end(); ++i)
      if (r.valid(i)) {
        const RayOrigins::Contact contact = origins.contact(r.position[i]);
        r.origin[i] += contact.distance * side[i];
        r.touches[i] = contact.touches;
      }
  });
  warn_of_large_triangles(r);
}

namespace {

Receivers on_plane(const PlaneGrid& plane, const Mesh& mesh) {
  Receivers r;
  r.width = r.height = plane.resolution;
  for (int j = 0; j < r.height; ++j)
    for (int i = 0; i < r.width; ++i) {
      const auto along = [&](int k) { return plane.half_extent * (2.0f * (float(k) + 0.5f) / float(r.width) - 1.0f); };
      r.position.emplace_back(plane.x + along(i), plane.y, plane.z + along(j));
    }
  r.normal.assign(r.position.size(), vec3(0, 1, 0));
  r.on_occluder.assign(r.position.size(), 0);
  const RayScene rays(mesh);
  place_ray_origins(r, r.normal, mesh, rays);
  return r;
}

Receivers on_vertices(const Mesh& mesh) {
  if (mesh.empty()) throw Error("receivers: vertices = true needs an occluder mesh");
  Receivers r;
  r.width = int(mesh.positions.size());
  r.height = 1;
  r.position = mesh.positions;
  r.normal = vertex_normals(mesh);
  r.on_occluder.assign(r.position.size(), 1);
  const RayScene rays(mesh);
  place_ray_origins(r, geometric_normals(mesh), mesh, rays);
  return r;
}

/// What a pixel of a camera shows: the mesh, the ground, or what a mirror shows of these.
class PixelFinder {
 public:
  /// `mesh` is what is seen as itself, without mirrors; `rays` are of it.
  PixelFinder(const Camera& camera, const std::vector<Mirror>& mirrors, const Mesh& mesh, const RayScene& rays)
      : camera_(camera), mirrors_(mirrors), mesh_(mesh), rays_(rays), normals_(vertex_normals(mesh)) {
    if (!mirrors.empty()) origins_.emplace(mesh, rays);
    forward_ = glm::normalize(camera.target - camera.eye);
    right_ = glm::normalize(glm::cross(forward_, std::abs(forward_.y) > 0.999f ? vec3(0, 0, -1) : vec3(0, 1, 0)));
    up_ = glm::cross(right_, forward_);
    scale_ = std::tan(glm::radians(0.5f * camera.vertical_fov));
  }

  /// Fills receiver (x, y) and the side of its surface that is seen.
  void find(int x, int y, Receivers& r, vec3& side) const {
    const std::size_t k = std::size_t(y) * r.width + x;
    const Sight first = look(camera_.eye, direction(x, y));
    // A mirror that lies on a surface hides it: which of them is nearer is rounding.
    const auto mirror = nearest_mirror(mirrors_, camera_.eye, first.towards, same * first.distance);
    if (!mirror) return place(first, 0.0f, r, k, side);
    const Reflection& at = mirror->at;
    const Sight second = look(at.point + origins_->contact(at.point).distance * at.normal, at.direction);
    if (!meets_another(*mirror, second)) place(second, at.distance, r, k, side);
  }

 private:
  /// What lies on a ray: the mesh where `hit` says so, else the ground, else nothing.
  struct Sight {
    vec3 from, towards;
    float distance;
    Hit hit;
  };

  Sight look(vec3 from, vec3 towards) const {
    Sight sight{from, towards, 0.0f, rays_.intersect(from, towards)};
    sight.distance = sight.hit.distance;
    const float ground = camera_.has_ground ? (camera_.ground - from.y) / towards.y : -1.0f;
    // A mesh that has a ground of its own at the same height is the ground: which of them is nearer is rounding.
    if (ground > 0.0f && std::isfinite(ground) && ground < sight.distance * same) {
      sight.distance = ground;
      sight.hit.distance = std::numeric_limits<float>::infinity();
    }
    return sight;
  }

  /// Light is followed through one mirror. A mirror does not see itself, but from within a ball.
  bool meets_another(const Mirrored& mirror, const Sight& second) const {
    for (std::size_t i = 0; i < mirrors_.size(); ++i) {
      const auto* ball = std::get_if<Sphere>(&mirrors_[i].shape);
      const bool within = ball && glm::distance(camera_.eye, ball->centre) < ball->radius;
      if (i == mirror.mirror && !within) continue;
      const auto at = meet(mirrors_[i], mirror.at.point, mirror.at.direction);
      if (at && at->distance <= same * second.distance) return true;
    }
    return false;
  }

  void place(const Sight& sight, float before, Receivers& r, std::size_t k, vec3& side) const {
    if (!std::isfinite(sight.distance)) return;
    r.view_depth[k] = before + sight.distance;
    if (sight.hit) return place_on_mesh(sight, r, k, side);
    r.position[k] = sight.from + sight.distance * sight.towards;
    r.position[k].y = camera_.ground;
    r.normal[k] = side = {0, 1, 0};
  }

  vec3 direction(int x, int y) const {
    const float px = (2.0f * (float(x) + 0.5f) - float(camera_.width)) / float(camera_.height) * scale_;
    const float py = (1.0f - 2.0f * (float(y) + 0.5f) / float(camera_.height)) * scale_;
    return glm::normalize(forward_ + px * right_ + py * up_);
  }

  void place_on_mesh(const Sight& sight, Receivers& r, std::size_t k, vec3& side) const {
    const Hit& hit = sight.hit;
    const uvec3 t = mesh_.triangles[hit.triangle];
    const dvec3 a = mesh_.positions[t.x], b = mesh_.positions[t.y], c = mesh_.positions[t.z];
    const double u = hit.u, v = hit.v, w = 1.0 - u - v;
    r.position[k] = vec3(w * a + u * b + v * c);
    r.on_occluder[k] = 1;
    side = vec3(glm::normalize(glm::cross(b - a, c - a)));
    vec3 n = float(w) * normals_[t.x] + hit.u * normals_[t.y] + hit.v * normals_[t.z];
    if (glm::dot(n, n) == 0.0f) n = side;
    if (mesh_.normals.empty() && glm::dot(n, side) <= 0.0f) n = side;  // a wall of two sides whose means cancel
    if (glm::dot(side, sight.towards) > 0.0f) side = -side, n = -n;    // a back face
    r.normal[k] = glm::normalize(n);
  }

  static constexpr float same = 1.0f + 1e-5f;  ///< up to which distances differ by rounding alone

  const Camera& camera_;
  const std::vector<Mirror>& mirrors_;
  const Mesh& mesh_;
  const RayScene& rays_;
  std::optional<RayOrigins> origins_;  ///< where rays leave a mirror
  std::vector<vec3> normals_;
  vec3 forward_, right_, up_;
  float scale_;
};

Receivers through_camera(const Camera& camera, const std::vector<Mirror>& mirrors, const Mesh& mesh) {
  const bool blocked_by_mirrors = std::any_of(mirrors.begin(), mirrors.end(), [](const Mirror& m) { return m.shadow; });
  const Mesh without = blocked_by_mirrors ? without_mirrors(mesh, mirrors) : Mesh{};
  const RayScene rays(mesh), rays_without(without);
  const PixelFinder finder(camera, mirrors, blocked_by_mirrors ? without : mesh,
                           blocked_by_mirrors ? rays_without : rays);
  Receivers r;
  r.width = camera.width;
  r.height = camera.height;
  const auto size = std::size_t(r.width) * r.height;
  r.position.assign(size, vec3(0.0f));
  r.normal.assign(size, vec3(0.0f));
  r.view_depth.assign(size, std::numeric_limits<float>::infinity());
  r.on_occluder.assign(size, 0);
  std::vector<vec3> side(size, vec3(0.0f));
  tbb::parallel_for(0, r.height, [&](int y) {
    for (int x = 0; x < r.width; ++x) finder.find(x, y, r, side[std::size_t(y) * r.width + x]);
  });
  place_ray_origins(r, side, mesh, rays);
  return r;
}

}  // namespace

Receivers subset(const Receivers& all, const std::vector<std::size_t>& which, int width, int height) {
  Receivers r;
  r.width = width, r.height = height;
  const auto take = [&](auto& to, const auto& from) {
    if (from.empty()) return;
    to.reserve(which.size());
    for (const std::size_t i : which) to.push_back(from[i]);
  };
  take(r.position, all.position), take(r.normal, all.normal), take(r.albedo, all.albedo);
  take(r.origin, all.origin), take(r.touches, all.touches);
  take(r.view_depth, all.view_depth), take(r.on_occluder, all.on_occluder);
  return r;
}

Receivers make_receivers(const ReceiverSpec& spec, const Mesh& mesh) {
  Receivers r;
  if (const auto* plane = std::get_if<PlaneGrid>(&spec.kind)) r = on_plane(*plane, mesh);
  else if (const auto* camera = std::get_if<Camera>(&spec.kind)) r = through_camera(*camera, spec.mirrors, mesh);
  else r = on_vertices(mesh);
  r.albedo.assign(r.position.size(), spec.albedo);
  return r;
}

}  // namespace penumbra
