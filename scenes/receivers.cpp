#include "scenes/receivers.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "scenes/error.h"
#include "scenes/ray_scene.h"

namespace penumbra {
namespace {

Receivers on_plane(const PlaneGrid& plane) {
  Receivers r;
  r.width = r.height = plane.resolution;
  for (int j = 0; j < r.height; ++j)
    for (int i = 0; i < r.width; ++i) {
      const auto along = [&](int k) { return plane.half_extent * (2.0f * (float(k) + 0.5f) / float(r.width) - 1.0f); };
      r.position.emplace_back(along(i), plane.y, along(j));
    }
  r.normal.assign(r.position.size(), vec3(0, 1, 0));
  r.on_occluder.assign(r.position.size(), 0);
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
  return r;
}

Receivers through_camera(const Camera& camera, const Mesh& mesh) {
  const RayScene rays(mesh);
  const std::vector<vec3> normals = vertex_normals(mesh);
  const vec3 forward = glm::normalize(camera.target - camera.eye);
  const vec3 right = glm::normalize(glm::cross(forward, std::abs(forward.y) > 0.999f ? vec3(0, 0, -1) : vec3(0, 1, 0)));
  const vec3 up = glm::cross(right, forward);
  const float scale = std::tan(glm::radians(0.5f * camera.vertical_fov));

  Receivers r;
  r.width = camera.width;
  r.height = camera.height;
  const auto size = std::size_t(r.width) * r.height;
  r.position.assign(size, vec3(0.0f));
  r.normal.assign(size, vec3(0.0f));
  r.view_depth.assign(size, std::numeric_limits<float>::infinity());
  r.on_occluder.assign(size, 0);
  tbb::parallel_for(0, r.height, [&](int y) {
    for (int x = 0; x < r.width; ++x) {
      const float px = (2.0f * (float(x) + 0.5f) - float(r.width)) / float(r.height) * scale;
      const float py = (1.0f - 2.0f * (float(y) + 0.5f) / float(r.height)) * scale;
      const vec3 direction = glm::normalize(forward + px * right + py * up);
      const std::size_t k = std::size_t(y) * r.width + x;
      const Hit hit = rays.intersect(camera.eye, direction);
      const float ground = camera.has_ground ? (camera.ground - camera.eye.y) / direction.y : -1.0f;
      if (ground > 0.0f && std::isfinite(ground) && ground < hit.distance) {
        r.view_depth[k] = ground;
        r.normal[k] = {0, 1, 0};
      } else if (hit) {
        const uvec3 t = mesh.triangles[hit.triangle];
        vec3 n = (1.0f - hit.u - hit.v) * normals[t.x] + hit.u * normals[t.y] + hit.v * normals[t.z];
        if (glm::dot(n, n) == 0.0f) n = hit.normal;
        if (glm::dot(n, direction) > 0.0f && glm::dot(hit.normal, direction) > 0.0f) n = -n;  // a back face
        r.view_depth[k] = hit.distance;
        r.normal[k] = glm::normalize(n);
        r.on_occluder[k] = 1;
      } else {
        continue;
      }
      r.position[k] = camera.eye + r.view_depth[k] * direction;
    }
  });
  return r;
}

}  // namespace

Receivers make_receivers(const ReceiverSpec& spec, const Mesh& mesh) {
  Receivers r;
  if (const auto* plane = std::get_if<PlaneGrid>(&spec.kind)) r = on_plane(*plane);
  else if (const auto* camera = std::get_if<Camera>(&spec.kind)) r = through_camera(*camera, mesh);
  else r = on_vertices(mesh);
  r.albedo.assign(r.position.size(), spec.albedo);
  return r;
}

}  // namespace penumbra
