#include "scenes/import/turn.h"

#include <fmt/format.h>
#include <algorithm>

#include <numeric>

namespace penumbra {
namespace {

std::array<dvec3, 3> points_of(const RawMesh& mesh, const RawTriangle& t) {
  return {mesh.positions[t.corners[0].position], mesh.positions[t.corners[1].position],
          mesh.positions[t.corners[2].position]};
}

/// Twice the area times the cosine between winding and normals: negative if they disagree.
double agreement(const RawMesh& mesh, const RawTriangle& t) {
  if (!t.file_normals) return 0.0;
  dvec3 sum(0.0);
  for (const Corner& corner : t.corners)
    if (corner.normal != no_normal) sum += unit_or_zero(mesh.normals[corner.normal]);
  const auto [a, b, c] = points_of(mesh, t);
  const dvec3 unit = unit_or_zero(sum);
  return glm::dot(glm::cross(b - a, c - a), unit);
}

class Sets {  // disjoint sets (Tarjan 1975)
 public:
  explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
  unsigned find(unsigned i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(unsigned a, unsigned b) { parent_[find(a)] = find(b); }

 private:
  std::vector<unsigned> parent_;
};

struct Edge {
  unsigned low, high, triangle;
  bool upward;  // runs from low to high
};

/// Triangles that hang together by edges which exactly two share and run through in opposite directions.
Sets patches(const std::vector<RawTriangle>& triangles, const std::vector<unsigned>& place) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (unsigned t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; triangles[t].file_normals && k < 3; ++k) {
      const auto& corners = triangles[t].corners;
      const unsigned from = place[corners[k].position], to = place[corners[(k + 1) % 3].position];
      edges.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  const auto same = [](const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; };
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  Sets sets(triangles.size());
  for (std::size_t first = 0, last; first < edges.size(); first = last) {
    for (last = first + 1; last < edges.size() && same(edges[first], edges[last]);) ++last;
    if (last - first == 2 && edges[first].upward != edges[first + 1].upward)
      sets.join(edges[first].triangle, edges[first + 1].triangle);
  }
  return sets;
}

struct Patch {
  double agreement = 0.0, volume = 0.0;  // six times the volume about `first`
  dvec3 first{0.0};
  bool is_new = true;
};

std::vector<Patch> sums(const RawMesh& mesh, const std::vector<double>& agreements, Sets& sets) {
  std::vector<Patch> out(mesh.triangles.size());
  for (unsigned t = 0; t < mesh.triangles.size(); ++t) {
    Patch& patch = out[sets.find(t)];
    const auto [a, b, c] = points_of(mesh, mesh.triangles[t]);
    if (patch.is_new) patch.first = a, patch.is_new = false;
    patch.agreement += agreements[t];
    patch.volume += glm::dot(a - patch.first, glm::cross(b - patch.first, c - patch.first));
  }
  return out;
}

/// Returns how many.
std::size_t turn_patches(RawMesh& mesh, const std::vector<double>& agreements, const std::vector<unsigned>& place) {
  Sets sets = patches(mesh.triangles, place);
  const std::vector<Patch> patch = sums(mesh, agreements, sets);
  std::size_t turned = 0;
  for (unsigned t = 0; t < mesh.triangles.size(); ++t) {
    const Patch& mine = patch[sets.find(t)];
    if (mine.agreement >= 0.0 || (mesh.facets && mine.volume > 0.0)) continue;
    std::swap(mesh.triangles[t].corners[1], mesh.triangles[t].corners[2]);
    ++turned;
  }
  return turned;
}

}  // namespace

void turn_to_normals(RawMesh& mesh, const std::vector<unsigned>& place, const std::string& path, Outbox& says) {
  std::vector<double> agreements;
  agreements.reserve(mesh.triangles.size());
  for (const RawTriangle& t : mesh.triangles) agreements.push_back(agreement(mesh, t));
  if (std::any_of(agreements.begin(), agreements.end(), [](double a) { return a < 0.0; }))
    if (const std::size_t turned = turn_patches(mesh, agreements, place))
      says.info(fmt::format("{}: {} of {} triangles are wound against the file's normals and were turned around", path,
                            turned, mesh.triangles.size()));
  if (mesh.facets)
    for (RawTriangle& t : mesh.triangles) mesh.make_flat(t);
}

}  // namespace penumbra
