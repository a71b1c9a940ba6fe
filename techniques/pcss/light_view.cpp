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

/// Depths of the occluder in front of the light.
struct Depths {
  float near = infinity, far = 0.0f;
  bool behind = false;  ///< a part of the occluder is
};

Depths measure(const LightView& view, const Mesh& mesh) {
  Depths depths;
  for (const vec3& p : mesh.positions) {
    const float z = view.depth(p);
    depths.far = std::max(depths.far, z);
    if (z > 0.0f) depths.near = std::min(depths.near, z);
    else depths.behind = true;
  }
  return depths;
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
  view.perspective = settings.perspective;
  view.resolution = settings.resolution;
  set_axes(light, settings.light_scale, view);
  const Depths depths = measure(view, mesh);
  view.near = 1.0f;
  view.farthest = farthest_receiver(view, receivers);
  if (!(depths.far > 0.0f)) {  // nothing in front of the light: an empty map
    view.density = float(settings.resolution);
    return view;
  }

  const Bounds box = bounds(mesh);
  view.near = std::max(depths.near, 1e-3f * glm::length(box.extent()));
  if (!view.perspective) {
    const vec3 to = box.centre() - view.centre;
    const float distance = std::max(view.depth(box.centre()), view.near);
    view.shear = vec2(glm::dot(view.across_u, to), glm::dot(view.across_v, to)) / distance;
    view.spread /= distance;
  }
  const vec2 edges(glm::length(view.edge_u), glm::length(view.edge_v));
  const vec2 most = view.perspective ? vec2(6.0f) / edges : vec2(infinity);  // tan of 80 degrees
  Box window;  // low and density are still 0 and 1: project() and widest() give q itself
  for (const vec3& p : mesh.positions) {
    const float z = view.depth(p);
    if (!(z > 0.0f)) continue;
    const vec2 q = view.project(p, z);
    outside += z < view.near || glm::any(glm::greaterThan(glm::abs(q), most));
    window.add(q);
  }
  if (view.perspective && depths.behind) window.add(-most), window.add(most);  // it may pass anywhere
  const float widest = float(settings.margin) * view.widest();
  window.low -= widest, window.high += widest;
  window.cut(most);
  const vec2 extent = window.high - window.low, middle = 0.5f * (window.low + window.high);
  const float edge = std::max({extent.x, extent.y, 1e-6f}) * (1.0f + 2.0f / float(settings.resolution));
  view.low = middle - 0.5f * edge;
  view.density = float(settings.resolution) / edge;
  view.spread *= view.density;
  view.metres = std::max(edges.x, edges.y) / view.density;
  return view;
}

}  // namespace penumbra::pcss
