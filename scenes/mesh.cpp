#include "scenes/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/error.h"

namespace penumbra {

dvec3 local_origin(dvec3 centre, double size) {
  if (!(size > 0.0) || !std::isfinite(size)) return centre;
  const double cell = std::exp2(std::ceil(std::log2(4.0 * size)));
  return glm::round(centre / cell) * cell;
}

Mesh narrowed(const ImportedMesh& mesh, dvec3 origin) {
  Mesh out;
  out.origin = origin;
  out.triangles = mesh.triangles;
  out.normals = mesh.normals;
  out.positions.reserve(mesh.positions.size());
  for (const dvec3& p : mesh.positions) out.positions.emplace_back(p - origin);
  return out;
}

Mesh narrowed(const ImportedMesh& mesh) {
  const Box<dvec3> box = bounds(mesh);
  const dvec3 extent = box.extent();
  return narrowed(mesh, local_origin(box.centre(), std::max({extent.x, extent.y, extent.z})));
}

std::size_t count_coarse(const Mesh& mesh) {
  const auto coarse = [&](const uvec3& t) {
    const dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const double edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    const double away = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
    return away * 0x1p-24 > 1e-3 * edge && edge > 0.0;
  };
  return std::size_t(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), coarse));
}

ImportedMesh widened(const Mesh& mesh) {
  ImportedMesh out{{}, mesh.triangles, mesh.normals};
  out.positions.reserve(mesh.positions.size());
  for (const vec3& p : mesh.positions) out.positions.push_back(mesh.origin + dvec3(p));
  return out;
}

void append(Mesh& mesh, const Mesh& part) {
  const auto first = unsigned(mesh.positions.size());
  const bool shaded = !mesh.normals.empty() || !part.normals.empty();
  if (shaded) mesh.normals.resize(mesh.positions.size(), vec3(0.0f));
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  if (shaded) mesh.normals.resize(mesh.positions.size(), vec3(0.0f));
  mesh.triangles.reserve(mesh.triangles.size() + part.triangles.size());
  for (const uvec3& t : part.triangles) mesh.triangles.push_back(t + first);
}

Mesh load_mesh(const std::string& path) {
  Mesh mesh = narrowed(import_mesh(path));
  validate(mesh, path);
  return mesh;
}

namespace {

template <class Vector>
Box<Vector> box_of(const std::vector<Vector>& positions, const std::vector<uvec3>& triangles) {
  if (triangles.empty()) return {};
  Box<Vector> box{positions[triangles[0].x], positions[triangles[0].x]};
  for (const uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) {
      box.low = glm::min(box.low, positions[t[k]]);
      box.high = glm::max(box.high, positions[t[k]]);
    }
  return box;
}

}  // namespace

Bounds bounds(const Mesh& mesh) {
  return box_of(mesh.positions, mesh.triangles);
}

Box<dvec3> bounds(const ImportedMesh& mesh) {
  return box_of(mesh.positions, mesh.triangles);
}

std::vector<vec3> geometric_normals(const Mesh& mesh) {
  std::vector<dvec3> sum(mesh.positions.size(), dvec3(0.0));
  for (const uvec3& t : mesh.triangles) {
    const dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const dvec3 n = glm::cross(b - a, c - a);  // length is twice the area
    for (int k = 0; k < 3; ++k) sum[t[k]] += n;
  }
  std::vector<vec3> normals(sum.size(), vec3(0.0f));
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double length = glm::length(sum[i]);
    if (length > 0.0) normals[i] = vec3(sum[i] / length);
  }
  return normals;
}

std::vector<vec3> vertex_normals(const Mesh& mesh) {
  std::vector<vec3> normals = geometric_normals(mesh);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i)
    if (mesh.normals[i] != vec3(0.0f)) normals[i] = mesh.normals[i];
  return normals;
}

void validate(const Mesh& mesh, const std::string& what) {
  if (mesh.empty()) throw Error("{}: the mesh has no triangles", what);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec3& p = mesh.positions[i];
    if (!glm::all(glm::lessThan(glm::abs(p), vec3(std::numeric_limits<float>::max()))))
      throw Error("{}: vertex {} is not finite ({}, {}, {})", what, i, p.x, p.y, p.z);
  }
  for (const uvec3& t : mesh.triangles)
    if (glm::any(glm::greaterThanEqual(t, uvec3(static_cast<unsigned>(mesh.positions.size())))))
      throw Error("{}: a triangle names vertex {} of {}", what, std::max({t.x, t.y, t.z}), mesh.positions.size());
}

Similarity fit_to(const Box<dvec3>& box, double height, bool on_ground, dvec3 at) {
  Similarity fit;
  if (height > 0.0 && box.extent().y > 0.0) fit.scale = height / box.extent().y;
  const dvec3 centre = box.centre();
  fit.offset = at - fit.scale * dvec3(centre.x, on_ground ? box.low.y : 0.0, centre.z);
  return fit;
}

}  // namespace penumbra
