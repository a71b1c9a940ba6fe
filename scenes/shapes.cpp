#include "scenes/shapes.h"

#include <cmath>
#include <functional>
#include <random>

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

namespace {

/// A box whose faces share no vertices, so that its vertex normals are those of the faces.
Mesh make_flat_box(vec3 low, vec3 high) {
  const Mesh box = make_box(low, high);
  Mesh flat;
  for (const uvec3& t : box.triangles) {
    const auto first = unsigned(flat.positions.size());
    for (int k = 0; k < 3; ++k) flat.positions.push_back(box.positions[t[k]]);
    flat.triangles.emplace_back(first, first + 1, first + 2);
  }
  return flat;
}

Mesh moved(Mesh mesh, vec3 offset) {
  for (vec3& p : mesh.positions) p += offset;
  return mesh;
}

}  // namespace

Mesh make_still_life() {
  Mesh mesh = make_sphere({-0.7f, 0.45f, 0.1f}, 0.45f, 96);
  append(mesh, make_flat_box({0.25f, 0.0f, -0.7f}, {0.75f, 1.1f, -0.2f}));
  append(mesh, moved(make_torus(0.38f, 0.12f, 96, 32), {0.6f, 0.12f, 0.7f}));
  return mesh;
}

Mesh make_fence(int bars, float thickness) {
  const float half = 0.5f * thickness;
  Mesh mesh;
  for (int k = 0; k < bars; ++k) {
    const float x = bars > 1 ? -1.0f + 2.0f * float(k) / float(bars - 1) : 0.0f;
    append(mesh, make_flat_box({x - half, 0.0f, -half}, {x + half, 1.0f, half}));
  }
  for (const float y : {0.2f, 0.8f})
    append(mesh, make_flat_box({-1.0f - half, y - half, -2 * half}, {1.0f + half, y + half, -half}));
  return mesh;
}

Mesh make_two_blockers() {
  Mesh mesh = make_flat_box({-0.6f, 0.4f, -0.6f}, {0.6f, 0.42f, 0.2f});
  append(mesh, make_flat_box({-0.2f, 1.4f, -0.2f}, {0.9f, 1.42f, 0.7f}));
  return mesh;
}

Mesh make_primitives(unsigned seed, int count) {
  std::mt19937 random(seed);  // its numbers are fixed by the standard; the library's distributions are not
  const auto unit = [&] { return float(random() >> 8) * 0x1p-24f; };
  Mesh mesh;
  for (int k = 0; k < count; ++k) {
    const float size = 0.1f + 0.4f * unit(), angle = 2.0f * float(pi) * unit(), reach = 1.8f * std::sqrt(unit());
    Mesh part = k % 3 == 0   ? make_flat_box(vec3(-0.4f * size), vec3(0.4f * size))
                : k % 3 == 1 ? make_sphere(vec3(0.0f), 0.5f * size, 48)
                             : make_torus(0.4f * size, 0.1f * size, 48, 16);
    const float tilt = 2.0f * float(pi) * unit(), turn = 2.0f * float(pi) * unit();
    const vec3 place(reach * std::cos(angle), 0.5f * size + unit() * (1.95f - size), reach * std::sin(angle));
    for (vec3& p : part.positions) {
      p = {p.x, std::cos(tilt) * p.y - std::sin(tilt) * p.z, std::sin(tilt) * p.y + std::cos(tilt) * p.z};
      p = vec3(std::cos(turn) * p.x + std::sin(turn) * p.z, p.y, std::cos(turn) * p.z - std::sin(turn) * p.x) + place;
    }
    append(mesh, part);
  }
  return mesh;
}

bool has_seed(const std::string& shape) {
  return shape == "primitives" || shape == "foliage";
}

bool make_shape(const std::string& name, Mesh& mesh, unsigned seed) {
  if (name == "torus-knot") mesh = make_torus_knot();
  else if (name == "torus") mesh = make_torus(1.0f, 0.4f, 48, 24);
  else if (name == "sphere") mesh = make_sphere(vec3(0.0f), 1.0f);
  else if (name == "resting-sphere") mesh = make_sphere(vec3(0, 0.5f, 0), 0.5f);
  else if (name == "box") mesh = make_box(vec3(-0.5f), vec3(0.5f));
  else if (name == "bowl") mesh = make_bowl(1.0f);
  else if (name == "still-life") mesh = make_still_life();
  else if (name == "fence") mesh = make_fence(25, 0.03f);
  else if (name == "two-blockers") mesh = make_two_blockers();
  else if (name == "primitives") mesh = make_primitives(seed);
  else if (name == "foliage") mesh = make_foliage(seed);
  else if (name == "none") mesh = {};
  else return false;
  return true;
}

}  // namespace penumbra
