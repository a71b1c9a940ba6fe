#include "scenes/import/turn.h"

#include <fmt/format.h>
#include <algorithm>

#include <numeric>

namespace penumbra {
namespace {

/// Twice the area times the cosine between winding and normals: negative if they disagree.
double agreement(const ImportedMesh& mesh, const uvec3& t) {
  const dvec3 a = mesh.positions[t.x];
  const dvec3 across = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
  const dvec3 normal = dvec3(mesh.normals[t.x]) + dvec3(mesh.normals[t.y]) + dvec3(mesh.normals[t.z]);
  const double length = glm::length(normal);
  return length > 0.0 ? glm::dot(across, normal) / length : 0.0;
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
Sets patches(const std::vector<RawTriangle>& raw, const std::vector<unsigned>& place) {
  std::vector<Edge> edges;
  edges.reserve(3 * raw.size());
  for (unsigned t = 0; t < raw.size(); ++t)
    for (std::size_t k = 0; raw[t].file_normals && k < 3; ++k) {
      const unsigned from = place[raw[t].corners[k].position], to = place[raw[t].corners[(k + 1) % 3].position];
      edges.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  const auto same = [](const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; };
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  Sets sets(raw.size());
  for (std::size_t first = 0, last; first < edges.size(); first = last) {
    for (last = first + 1; last < edges.size() && same(edges[first], edges[last]);) ++last;
    if (last - first == 2 && edges[first].upward != edges[first + 1].upward)
      sets.join(edges[first].triangle, edges[first + 1].triangle);
  }
  return sets;
}

}  // namespace

void turn_to_normals(ImportedMesh& mesh, const std::vector<RawTriangle>& raw, const std::vector<unsigned>& place,
                     const std::string& path, Outbox& says) {
  std::vector<double> votes(raw.size(), 0.0);
  for (std::size_t t = 0; t < raw.size(); ++t)
    if (raw[t].file_normals) votes[t] = agreement(mesh, mesh.triangles[t]);
  if (std::none_of(votes.begin(), votes.end(), [](double vote) { return vote < 0.0; })) return;
  Sets sets = patches(raw, place);
  std::vector<double> total(raw.size(), 0.0);
  for (unsigned t = 0; t < raw.size(); ++t) total[sets.find(t)] += votes[t];
  std::size_t turned = 0;
  for (unsigned t = 0; t < raw.size(); ++t)
    if (total[sets.find(t)] < 0.0) std::swap(mesh.triangles[t].y, mesh.triangles[t].z), ++turned;
  if (turned > 0)
    says.info(fmt::format("{}: {} of {} triangles are wound against the file's normals and were turned around", path,
                          turned, raw.size()));
}

}  // namespace penumbra
