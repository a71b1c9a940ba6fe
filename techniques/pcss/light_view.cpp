#include "techniques/pcss/light_view.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra::pcss {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Box {
  vec2 low{infinity}, high{-infinity};
  void add(vec2 q) { low = glm::min(low, q), high = glm::max(high, q); }
  void add(const Box& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
  void grow(float by) { low -= by, high += by; }
  void cut(const Box& most) {
    low = glm::clamp(low, most.low, most.high), high = glm::clamp(high, most.low, most.high);
  }
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

/// Where the valid receivers in front of the light lie: q, and depth of the farthest, m; 0 if there is none.
struct Footing {
  Box window;
  float farthest = 0.0f;
};

Footing find_receivers(const LightView& view, const Receivers& receivers) {
  const auto add = [&](const tbb::blocked_range<int>& range, Footing sum) {
    for (int i = range.begin(); i < range.end(); ++i) {
      const float z = view.depth(receivers.position[i]);
      if (!(z > 0.0f) || !(z < infinity) || !receivers.valid(i)) continue;
      sum.window.add(view.project(receivers.position[i], z));
      sum.farthest = std::max(sum.farthest, z);
    }
    return sum;
  };
  return tbb::parallel_reduce(tbb::blocked_range<int>(0, receivers.size(), 4096), Footing{}, add,
                              [](Footing a, const Footing& b) {
                                a.window.add(b.window);
                                a.farthest = std::max(a.farthest, b.farthest);
                                return a;
                              });
}

/// The vertices of triangles that may stand between the light and a receiver. A triangle whose nearest corner has the
/// depth z casts a penumbra of at most width(z, farthest) about itself, so where that does not meet the receivers, the
/// map need not hold it: a part of the mesh that stands elsewhere changes nothing.
std::vector<std::uint8_t> find_blockers(const LightView& view, const Mesh& mesh, const Footing& receivers,
                                        float margin) {
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
    if (!(near < receivers.farthest)) continue;
    const float reach = std::max(1.0f, margin) * view.width(near, receivers.farthest);
    const bool meets = glm::all(glm::lessThanEqual(window.low, receivers.window.high + reach)) &&
                       glm::all(glm::greaterThanEqual(window.high, receivers.window.low - reach));
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

Blockers measure(const LightView& view, const Mesh& mesh, const Footing& receivers, float margin) {
  const std::vector<std::uint8_t> found = find_blockers(view, mesh, receivers, margin);
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
  view.perspective = true;  // low and density are still 0 and 1: project() and width() give q itself
  const Footing footing = find_receivers(view, receivers);
  const Blockers blockers = measure(view, mesh, footing, float(settings.margin));
  view.perspective = settings.perspective;
  view.near = 1.0f;
  view.farthest = footing.farthest;
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
  const vec2 most = view.perspective ? vec2(6.0f) / edges : vec2(infinity);  // tan of 80 degrees
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
  window.grow(widest);
  Box looked_at = view.perspective ? footing.window : find_receivers(view, receivers).window;
  looked_at.grow(8.0f * widest);  // snapped regions are larger, and near the border shifted inside: keep it off
  window.cut(looked_at);
  window.cut({-most, most});
  const vec2 extent = window.high - window.low, middle = 0.5f * (window.low + window.high);
  const float least = 1e-6f / (view.perspective ? view.farthest : 1.0f);  // q of a perspective counts by 1 / m
  const float edge = std::max({extent.x, extent.y, least}) * (1.0f + 2.0f / float(settings.resolution));
  view.low = middle - 0.5f * edge;
  view.density = float(settings.resolution) / edge;
  view.spread *= view.density;
  view.metres = std::max(edges.x, edges.y) / view.density;
  return view;
}

}  // namespace penumbra::pcss
