#include "scenes/fit/solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "scenes/error.h"

namespace penumbra {
namespace {

using Edge = std::pair<unsigned, unsigned>;  // lower vertex first

Edge edge_of(const uvec3& t, int k) {
  return std::minmax(t[k], t[(k + 1) % 3]);
}
/// Does triangle t walk its edge k from the lower to the higher vertex?
bool forward(const uvec3& t, int k) {
  return t[k] < t[(k + 1) % 3];
}

/// Equal positions become one vertex; vertices no triangle names and triangles that collapse go.
Mesh welded(const Mesh& mesh, int& degenerate) {
  const auto hash = [](const vec3& p) {
    std::size_t h = 0;
    for (int c = 0; c < 3; ++c) h = h * 1000003 + std::hash<float>()(p[c]);
    return h;
  };
  std::unordered_map<vec3, unsigned, decltype(hash)> index(mesh.positions.size(), hash);
  Mesh out;
  for (const uvec3& t : mesh.triangles) {
    uvec3 joined;
    for (int k = 0; k < 3; ++k) {
      const auto [at, is_new] = index.try_emplace(mesh.positions[t[k]], unsigned(out.positions.size()));
      if (is_new) out.positions.push_back(mesh.positions[t[k]]);
      joined[k] = at->second;
    }
    if (joined.x == joined.y || joined.y == joined.z || joined.z == joined.x) ++degenerate;
    else out.triangles.push_back(joined);
  }
  return out;
}

class Topology {
 public:
  explicit Topology(Mesh& mesh) : mesh_(mesh) { connect(); }

  /// Drops small patches, bounded by edges of three triangles, that close a wall which is closed already.
  int drop_double_walls() {
    const std::vector<std::vector<unsigned>> patches = split_into_patches([](unsigned, int, unsigned, bool) {});
    std::vector<std::size_t> order(patches.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return patches[a].size() < patches[b].size(); });
    std::vector<char> dropped(mesh_.triangles.size());
    int walls = 0;
    for (const std::size_t p : order) {
      if (patches[p].size() * 100 > mesh_.triangles.size() || !is_double(patches[p])) continue;
      ++walls;
      for (const unsigned t : patches[p]) {
        dropped[t] = 1;
        for (int k = 0; k < 3; ++k) std::erase(edges_[edge_of(mesh_.triangles[t], k)], t);
      }
    }
    if (walls) {
      std::vector<uvec3> kept;
      for (std::size_t t = 0; t < dropped.size(); ++t)
        if (!dropped[t]) kept.push_back(mesh_.triangles[t]);
      mesh_.triangles = std::move(kept);
      connect();
    }
    return walls;
  }

  /// Throws if an edge has an odd number of triangles.
  void require_closed(const std::string& what) const {
    std::map<unsigned, std::vector<unsigned>> around;
    const Edge* first = nullptr;
    std::size_t open = 0;
    for (const auto& [edge, triangles] : edges_) {
      if (triangles.size() % 2 == 0) continue;
      ++open;
      if (!first) first = &edge;
      around[edge.first].push_back(edge.second), around[edge.second].push_back(edge.first);
    }
    if (!open) return;
    const vec3 p = mesh_.positions[first->first];
    throw Error(
        "{}: the mesh is not closed: {} of {} edges have an odd number of triangles, in {} holes or fins, one at "
        "({:.4g}, {:.4g}, {:.4g}); close them in a modeller, or give spheres as a list or a file",
        what, open, edges_.size(), count_components(around), p.x, p.y, p.z);
  }

  /// Makes neighbours agree, component by component; returns the components. Only swaps second and third corners.
  std::vector<std::vector<unsigned>> orient(const std::string& what) {
    return split_into_patches([&](unsigned from, int k, unsigned to, bool seen) {
      const uvec3& own = mesh_.triangles[from];
      uvec3& neighbour = mesh_.triangles[to];
      if (directs(neighbour, edge_of(own, k)) != forward(own, k)) return;
      if (seen) throw Error("{}: the mesh has one side only (like a Moebius strip) at triangle {}", what, to);
      std::swap(neighbour.y, neighbour.z);
    });
  }

  /// Throws if at some edge as many triangles do not leave as arrive.
  void require_balanced(const std::string& what) const {
    for (const auto& [edge, triangles] : edges_) {
      int balance = 0;
      for (const unsigned t : triangles) balance += directs(mesh_.triangles[t], edge) ? 1 : -1;
      if (balance == 0) continue;
      const vec3 p = mesh_.positions[edge.first];
      throw Error("{}: {} triangles meet at an edge at ({:.4g}, {:.4g}, {:.4g}) and no orientation fits all of them",
                  what, triangles.size(), p.x, p.y, p.z);
    }
  }

 private:
  void connect() {
    edges_.clear();
    for (unsigned t = 0; t < mesh_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) edges_[edge_of(mesh_.triangles[t], k)].push_back(t);
  }

  static bool directs(const uvec3& t, const Edge& edge) {
    for (int k = 0; k < 3; ++k)
      if (t[k] == edge.first && t[(k + 1) % 3] == edge.second) return true;
    return false;
  }

  /// Triangles connected through edges of exactly two triangles; cross(from, edge, to, seen) is called at each step.
  template <class Cross>
  std::vector<std::vector<unsigned>> split_into_patches(Cross cross) const {
    std::vector<std::vector<unsigned>> patches;
    std::vector<bool> seen(mesh_.triangles.size());
    for (unsigned seed = 0; seed < seen.size(); ++seed) {
      if (seen[seed]) continue;
      seen[seed] = true;
      std::vector<unsigned> patch{seed};
      for (std::size_t i = 0; i < patch.size(); ++i)
        for (int k = 0; k < 3; ++k) {
          const auto& both = edges_.at(edge_of(mesh_.triangles[patch[i]], k));
          if (both.size() != 2) continue;
          const unsigned other = both[0] == patch[i] ? both[1] : both[0];
          cross(patch[i], k, other, bool(seen[other]));
          if (!seen[other]) seen[other] = true, patch.push_back(other);
        }
      patches.push_back(std::move(patch));
    }
    return patches;
  }

  /// Would every edge of the patch's border still be shared by two triangles without it?
  bool is_double(const std::vector<unsigned>& patch) const {
    const std::set<unsigned> own(patch.begin(), patch.end());
    bool has_border = false;
    for (const unsigned t : patch)
      for (int k = 0; k < 3; ++k) {
        const auto& triangles = edges_.at(edge_of(mesh_.triangles[t], k));
        const auto inside =
            std::count_if(triangles.begin(), triangles.end(), [&](unsigned u) { return own.contains(u); });
        const auto outside = std::ptrdiff_t(triangles.size()) - inside;
        if (outside > 0) has_border = true;
        if (outside > 0 && (outside % 2 != 0 || inside % 2 == 0)) return false;
      }
    return has_border;
  }

  static int count_components(const std::map<unsigned, std::vector<unsigned>>& graph) {
    std::set<unsigned> seen;
    int components = 0;
    for (const auto& [seed, unused] : graph) {
      if (!seen.insert(seed).second) continue;
      ++components;
      std::vector<unsigned> stack;
      stack.push_back(seed);
      while (!stack.empty()) {
        const unsigned v = stack.back();
        stack.pop_back();
        for (const unsigned w : graph.at(v))
          if (seen.insert(w).second) stack.push_back(w);
      }
    }
    return components;
  }

  Mesh& mesh_;
  std::map<Edge, std::vector<unsigned>> edges_;
};

double signed_volume(const Mesh& mesh, const std::vector<unsigned>& triangles) {
  const dvec3 origin = mesh.positions[mesh.triangles[triangles[0]].x];  // near the mesh: no cancellation far from 0
  double sum = 0.0;
  for (const unsigned t : triangles) {
    const uvec3& v = mesh.triangles[t];
    sum += glm::dot(dvec3(mesh.positions[v.x]) - origin,
                    glm::cross(dvec3(mesh.positions[v.y]) - origin, dvec3(mesh.positions[v.z]) - origin));
  }
  return sum / 6.0;
}

/// How often a ray meets a set of triangles. Its direction has no simple ratios, so it misses edges of modelled meshes.
int crossings(const Mesh& mesh, const std::vector<unsigned>& triangles, dvec3 origin) {
  const dvec3 direction(0.5477225575, 0.6324555320, 0.5477225575 + 1e-3);
  int count = 0;
  for (const unsigned t : triangles) {
    const uvec3& v = mesh.triangles[t];
    const dvec3 a = mesh.positions[v.x], ab = dvec3(mesh.positions[v.y]) - a, ac = dvec3(mesh.positions[v.z]) - a;
    const dvec3 p = glm::cross(direction, ac), s = origin - a, q = glm::cross(s, ab);
    const double det = glm::dot(ab, p), u = glm::dot(s, p) / det, w = glm::dot(direction, q) / det;
    count += det != 0.0 && u >= 0.0 && w >= 0.0 && u + w <= 1.0 && glm::dot(ac, q) / det > 0.0;
  }
  return count;
}

/// Normals of a component point outward, or, if an odd number of others surrounds it, inward.
void point_outward(Mesh& mesh, const std::vector<std::vector<unsigned>>& components) {
  for (std::size_t c = 0; c < components.size(); ++c) {
    const dvec3 point = mesh.positions[mesh.triangles[components[c][0]].x];
    int depth = 0;
    for (std::size_t other = 0; other < components.size(); ++other)
      if (other != c) depth += crossings(mesh, components[other], point) % 2;
    const double volume = signed_volume(mesh, components[c]);
    if (volume == 0.0 || (volume > 0.0) == (depth % 2 == 0)) continue;
    for (const unsigned t : components[c]) std::swap(mesh.triangles[t].y, mesh.triangles[t].z);
  }
}

}  // namespace

std::string Repairs::describe() const {
  return fmt::format("{} degenerate triangles and {} double walls dropped, {} triangles turned around",
                     degenerate_triangles, double_walls, flipped_triangles);
}

Mesh make_solid(const Mesh& mesh, const std::string& what, Repairs* repairs) {
  validate(mesh, what);
  Repairs done;
  Mesh solid = welded(mesh, done.degenerate_triangles);
  if (solid.empty()) throw Error("{}: all {} triangles are degenerate", what, mesh.triangles.size());
  Topology topology(solid);
  done.double_walls = topology.drop_double_walls();
  topology.require_closed(what);
  const std::vector<uvec3> as_given = solid.triangles;
  point_outward(solid, topology.orient(what));
  topology.require_balanced(what);
  for (std::size_t t = 0; t < as_given.size(); ++t) done.flipped_triangles += as_given[t] != solid.triangles[t];
  if (repairs) *repairs = done;
  return solid;
}

double enclosed_volume(const Mesh& solid) {
  std::vector<unsigned> all(solid.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return signed_volume(solid, all);
}

}  // namespace penumbra
