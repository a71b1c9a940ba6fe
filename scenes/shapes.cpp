#include "scenes/shapes.h"

#include <cmath>
#include <functional>

namespace penumbra {
namespace {

/// A closed or open grid of points p(i, j), 0 <= i < rows, 0 <= j < columns, columns wrapped around.
Mesh grid(int rows, int columns, bool wrap_rows, const std::function<vec3(int, int)>& point) {
  Mesh mesh;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) mesh.positions.push_back(point(i, j));
  const auto at = [&](int i, int j) { return unsigned((i % rows) * columns + j % columns); };
  for (int i = 0; i < (wrap_rows ? rows : rows - 1); ++i)
    for (int j = 0; j < columns; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
      mesh.triangles.emplace_back(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  return mesh;
}

vec3 on_sphere(double polar, double azimuth) {
  return {std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth)};
}

/// A tube of circles around a closed curve.
Mesh tube(int along, int around, float radius, const std::function<dvec3(double)>& curve) {
  return grid(along, around, true, [&](int i, int j) {
    const double t = 2.0 * pi * i / along, h = 1e-4, a = 2.0 * pi * j / around;
    const dvec3 tangent = glm::normalize(curve(t + h) - curve(t - h));
    const dvec3 side = glm::normalize(glm::cross(tangent, curve(t + h) + curve(t - h)));
    const dvec3 up = glm::cross(side, tangent);
    return vec3(curve(t) + double(radius) * (std::cos(a) * side + std::sin(a) * up));
  });
}

}  // namespace

Mesh make_sphere(vec3 centre, float radius, int segments) {
  const int rings = segments / 2;  // interior rings 1 .. rings - 1, and the two poles
  Mesh mesh = grid(rings - 1, segments, false, [&](int i, int j) {
    return centre + radius * on_sphere(pi * (i + 1) / rings, 2.0 * pi * j / segments);
  });
  const auto top = unsigned(mesh.positions.size()), bottom = top + 1;
  mesh.positions.push_back(centre + vec3(0, radius, 0));
  mesh.positions.push_back(centre - vec3(0, radius, 0));
  const auto last = unsigned((rings - 2) * segments);
  for (unsigned j = 0; j < unsigned(segments); ++j) {
    const unsigned next = (j + 1) % unsigned(segments);
    mesh.triangles.emplace_back(top, j, next);
    mesh.triangles.emplace_back(bottom, last + next, last + j);
  }
  return mesh;
}

Mesh make_box(vec3 low, vec3 high) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
  const unsigned quads[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3}, {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
  for (const auto& q : quads) {
    mesh.triangles.emplace_back(q[0], q[1], q[2]);
    mesh.triangles.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

Mesh make_torus_knot(int p, int q, int along, int around) {
  return tube(along, around, 0.22f, [=](double t) {
    const double r = 0.7 + 0.3 * std::cos(q * t);
    return dvec3(r * std::cos(p * t), r * std::sin(p * t), 0.45 * std::sin(q * t));
  });
}

Mesh make_torus(float major, float minor, int along, int around) {
  return grid(along, around, true, [=](int i, int j) {
    const double t = 2.0 * pi * i / along, a = 2.0 * pi * j / around;
    const double r = major + minor * std::cos(a);
    return vec3(r * std::sin(t), minor * std::sin(a), r * std::cos(t));
  });
}

Mesh make_bowl(float radius, int segments) {
  const int rings = segments / 4;
  Mesh mesh = grid(rings, segments, false, [&](int i, int j) {
    return radius * on_sphere(0.5 * pi * (1.0 + double(i) / rings), 2.0 * pi * j / segments);
  });
  const auto bottom = unsigned(mesh.positions.size());
  const auto last = unsigned((rings - 1) * segments);
  mesh.positions.emplace_back(0, -radius, 0);
  for (unsigned j = 0; j < unsigned(segments); ++j)
    mesh.triangles.emplace_back(bottom, last + (j + 1) % unsigned(segments), last + j);
  for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);  // seen from inside
  return mesh;
}

bool make_shape(const std::string& name, Mesh& mesh) {
  if (name == "torus-knot") mesh = make_torus_knot();
  else if (name == "torus") mesh = make_torus(1.0f, 0.4f, 48, 24);
  else if (name == "sphere") mesh = make_sphere(vec3(0.0f), 1.0f);
  else if (name == "resting-sphere") mesh = make_sphere(vec3(0, 0.5f, 0), 0.5f);
  else if (name == "box") mesh = make_box(vec3(-0.5f), vec3(0.5f));
  else if (name == "bowl") mesh = make_bowl(1.0f);
  else if (name == "none") mesh = {};
  else return false;
  return true;
}

}  // namespace penumbra
