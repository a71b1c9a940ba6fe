#include "techniques/bases/shadow_map/light_view.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra::shadow_map {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Box {
  vec2 low{infinity}, high{-infinity};
  void add(vec2 q) { low = glm::min(low, q), high = glm::max(high, q); }
  void cut(vec2 most) { low = glm::clamp(low, -most, most), high = glm::clamp(high, -most, most); }
};

void set_axes(const AreaLight& light, double scale, LightView& view) {
  view.centre = light.centre;
  view.normal = light.normal;
  view.edge_u = light.edge_u, view.edge_v = light.edge_v;
  view.spread = float(scale * (light.shape == AreaLight::Shape::disc ? std::sqrt(pi) / 2.0 : 1.0));
  if (!(light.area() > 1e-24)) {  // a point; places in units of a smaller lamp's edges have no square in float
    orthonormal_frame(view.normal, view.edge_u, view.edge_v);
    view.spread = 0.0f;
  }
  const dvec3 u(view.edge_u), v(view.edge_v), n = glm::cross(u, v);  // float has no fourth power of 1e-12 or 1e12
  view.across_u = vec3(glm::cross(v, n) / glm::dot(n, n));
  view.across_v = vec3(glm::cross(n, u) / glm::dot(n, n));
}

/// Depth of the farthest valid receiver in front of the light, m; 0 if there is none.
float farthest_receiver(const LightView& view, const Receivers& receivers) {
  const auto farther = [&](const tbb::blocked_range<int>& range, float farthest) {
    for (int i = range.begin(); i < range.end(); ++i)
      if (const float z = view.depth(receivers.position[i]); z > farthest && z < infinity && receivers.valid(i))
        farthest = z;
    return farthest;
  };
  return tbb::parallel_reduce(tbb::blocked_range<int>(0, receivers.size(), 4096), 0.0f, farther,
                              [](float a, float b) { return std::max(a, b); });
}

/// q of what the light sees within 80 degrees of its axis.
vec2 widest_angle(const LightView& view) {
  return vec2(6.0f) / vec2(glm::length(view.edge_u), glm::length(view.edge_v));  // the tangent of 80 degrees
}

/// The vertices of triangles that may shadow a receiver: nearer to the light than the farthest one, and within the
/// angle that a map can hold. So a part of the mesh that stands far away changes nothing.
std::vector<std::uint8_t> find_blockers(LightView view, const Mesh& mesh) {
  view.perspective = true;
  const vec2 most = widest_angle(view);
  std::vector<std::uint8_t> found(mesh.positions.size(), 0);
  for (const uvec3& t : mesh.triangles) {
    Box window;
    float near = infinity;
    bool behind = false;
    for (int k = 0; k < 3; ++k) {
      const vec3 p = mesh.positions[t[k]];
      const float z = view.depth(p);
      if (z > 0.0f) near = std::min(near, z), window.add(view.project(p, z));
      else behind = true;
    }
    if (!(near < view.farthest)) continue;
    const bool meets =
        glm::all(glm::lessThanEqual(window.low, most)) && glm::all(glm::greaterThanEqual(window.high, -most));
    if (meets || behind)
      for (int k = 0; k < 3; ++k) found[t[k]] = 1;
  }
  return found;
}

/// The blockers: their box, and depths in front of the light.
struct Blockers {
  std::vector<vec3> points;
  float near = infinity, far = 0.0f;
  bool behind = false;  ///< a part of them is
  vec3 low{infinity}, high{-infinity};
};

Blockers measure(const LightView& view, const Mesh& mesh) {
  const std::vector<std::uint8_t> found = find_blockers(view, mesh);
  Blockers blockers;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) continue;
    const vec3 p = mesh.positions[i];
    const float z = view.depth(p);
    blockers.points.push_back(p);
    blockers.far = std::max(blockers.far, z);
    if (z > 0.0f) blockers.near = std::min(blockers.near, z);
    else blockers.behind = true;
    blockers.low = glm::min(blockers.low, p), blockers.high = glm::max(blockers.high, p);
  }
  return blockers;
}

}  // namespace

vec3 LightView::ray_origin(int column, int row) const {
  const vec2 q = middle(column, row);
  return perspective ? centre : centre + q.x * edge_u + q.y * edge_v;
}

vec3 LightView::ray_direction(int column, int row) const {
  const vec2 q = perspective ? middle(column, row) : shear;
  return normal + q.x * edge_u + q.y * edge_v;
}

LightView make_light_view(const AreaLight& light, const Mesh& mesh, const Receivers& receivers,
                          const LightViewSettings& settings, std::size_t& outside) {
  LightView view;
  outside = 0;
  view.resolution = settings.resolution;
  set_axes(light, settings.light_scale, view);
  view.perspective = settings.perspective;
  view.farthest = farthest_receiver(view, receivers);
  const Blockers blockers = measure(view, mesh);
  view.near = 1.0f;
  if (!(blockers.far > 0.0f)) {  // nothing in front of the light: an empty map
    view.density = float(settings.resolution);
    return view;
  }

  view.near = std::max(blockers.near, 1e-3f * glm::distance(blockers.low, blockers.high));
  if (!view.perspective) {
    const vec3 middle = 0.5f * (blockers.low + blockers.high), to = middle - view.centre;
    const float distance = std::max(view.depth(middle), view.near);
    view.shear = vec2(glm::dot(view.across_u, to), glm::dot(view.across_v, to)) / distance;
    view.spread /= distance;
  }
  const vec2 edges(glm::length(view.edge_u), glm::length(view.edge_v));
  const vec2 most = view.perspective ? widest_angle(view) : vec2(infinity);
  Box window;
  for (const vec3& p : blockers.points) {
    const float z = view.depth(p);
    if (!(z > 0.0f)) continue;
    const vec2 q = view.project(p, z);
    outside += z < view.near || glm::any(glm::greaterThan(glm::abs(q), most));
    window.add(q);
  }
  if (view.perspective && blockers.behind) window.add(-most), window.add(most);  // it may pass anywhere
  const float widest = float(settings.margin) * view.widest();
  window.low -= widest, window.high += widest;
  window.cut(most);
  const vec2 extent = window.high - window.low, middle = 0.5f * (window.low + window.high);
  const float least = 1e-6f / (view.perspective ? view.farthest : 1.0f);  // q of a perspective counts by 1 / m
  const float edge = std::max({extent.x, extent.y, least}) * (1.0f + 2.0f / float(settings.resolution));
  view.low = middle - 0.5f * edge;
  view.density = float(settings.resolution) / edge;
  view.spread *= view.density;
  view.metres = std::max(edges.x, edges.y) / view.density;
  return view;
}

}  // namespace penumbra::shadow_map
