#include "scenes/fit/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "scenes/error.h"
#include "scenes/fit/disjoint_sets.h"
#include "scenes/fit/shells.h"
#include "scenes/fit/union_surface.h"

namespace penumbra {
namespace {

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

/// Copies of a triangle, turned either way.
struct Copies {
  std::vector<unsigned> turned[2];
};

std::array<unsigned, 3> corners_in_order(const uvec3& t) {
  std::array<unsigned, 3> v{t.x, t.y, t.z};
  std::sort(v.begin(), v.end());
  return v;
}

bool all_different(const Mesh& mesh) {
  std::vector<std::array<unsigned, 3>> corners;
  for (const uvec3& t : mesh.triangles) corners.push_back(corners_in_order(t));
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) == corners.end();
}

/// Triangles by the vertices they join.
std::map<std::array<unsigned, 3>, Copies> copies_of(const Mesh& mesh) {
  std::map<std::array<unsigned, 3>, Copies> copies;
  for (unsigned t = 0; t < mesh.triangles.size(); ++t) {
    const uvec3& v = mesh.triangles[t];
    const bool even = (v.x < v.y) + (v.y < v.z) + (v.z < v.x) == 2;
    copies[corners_in_order(v)].turned[even].push_back(t);
  }
  return copies;
}

/// Leaves one copy of every triangle of a part that is closed with one of each, as parts written twice or with both
/// sides are. Elsewhere copies that are turned oppositely cancel, and of the others one or two stay, as their number is
/// odd or even; where none would, one pair stays. Returns how many went.
int drop_copies(Mesh& mesh) {
  if (all_different(mesh)) return 0;
  const auto copies = copies_of(mesh);
  DisjointSets parts(mesh.positions.size());
  std::map<Edge, unsigned> sides;
  for (const auto& [v, unused] : copies) {
    parts.join(v[0], v[1]), parts.join(v[1], v[2]);
    for (const Edge& e : {Edge{v[0], v[1]}, Edge{v[1], v[2]}, Edge{v[0], v[2]}}) ++sides[e];
  }
  std::vector<char> open(mesh.positions.size());
  for (const auto& [edge, count] : sides)
    if (count % 2 != 0) open[parts.of(edge.first)] = 1;
  std::vector<char> stays(mesh.triangles.size());
  for (const auto& [v, copy] : copies) {
    const auto &one = copy.turned[0], &other = copy.turned[1];
    const std::vector<unsigned>& more = one.size() > other.size() ? one : other;
    if (!open[parts.of(v[0])]) {
      stays[one.empty() ? other[0] : other.empty() ? one[0] : std::min(one[0], other[0])] = 1;
    } else if (one.size() == other.size()) {
      stays[one[0]] = stays[other[0]] = 1;
    } else {
      stays[more[0]] = 1;
      if ((one.size() + other.size()) % 2 == 0) stays[more[1]] = 1;
    }
  }
  std::vector<uvec3> kept;
  for (std::size_t t = 0; t < stays.size(); ++t)
    if (stays[t]) kept.push_back(mesh.triangles[t]);
  const int gone = int(mesh.triangles.size() - kept.size());
  mesh.triangles = std::move(kept);
  return gone;
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

  Junctions junctions() const {
    Junctions more;
    for (const auto& [edge, triangles] : edges_)
      if (triangles.size() != 2) more[edge] = triangles;
    return more;
  }

  /// Makes neighbours agree, patch by patch, the way most of its area is turned. Only swaps second and third corners.
  std::vector<Patch> orient(const std::string& what) {
    const std::vector<uvec3> given = mesh_.triangles;
    std::vector<Patch> patches;
    for (std::vector<unsigned>&triangles : split_into_patches([&](unsigned from, int k, unsigned to, bool seen) {
           const uvec3& own = mesh_.triangles[from];
           uvec3& neighbour = mesh_.triangles[to];
           if (directs(neighbour, edge_of(own, k)) != forward(own, k)) return;
           if (seen) throw Error("{}: the mesh has one side only (like a Moebius strip) at triangle {}", what, to);
           std::swap(neighbour.y, neighbour.z);
         })) {
      double kept = 0.0, turned = 0.0;
      for (const unsigned t : triangles) (mesh_.triangles[t] == given[t] ? kept : turned) += area(given[t]);
      if (turned > kept)
        for (const unsigned t : triangles) std::swap(mesh_.triangles[t].y, mesh_.triangles[t].z);
      patches.push_back({std::move(triangles), std::min(kept, turned) == 0.0});
    }
    return patches;
  }

 private:
  void connect() {
    edges_.clear();
    for (unsigned t = 0; t < mesh_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) edges_[edge_of(mesh_.triangles[t], k)].push_back(t);
  }

  double area(const uvec3& t) const {
    const dvec3 a = mesh_.positions[t.x];
    return glm::length(glm::cross(dvec3(mesh_.positions[t.y]) - a, dvec3(mesh_.positions[t.z]) - a));
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

}  // namespace

std::string Repairs::describe() const {
  const std::pair<int, const char*> all[] = {{degenerate_triangles, "degenerate triangles dropped"},
                                             {copies, "copies of triangles dropped"},
                                             {double_walls, "double walls dropped"},
                                             {flipped_triangles, "triangles turned around"},
                                             {inner_triangles, "triangles inside the solid removed or cut"}};
  std::string text;
  for (const auto& [count, what] : all)
    if (count) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  return text;
}

Mesh make_solid(const Mesh& mesh, const std::string& what, Repairs* repairs) {
  validate(mesh, what);
  Repairs done;
  Mesh solid = welded(mesh, done.degenerate_triangles);
  if (solid.empty()) throw Error("{}: all {} triangles are degenerate", what, mesh.triangles.size());
  done.copies = drop_copies(solid);
  Topology topology(solid);
  done.double_walls = topology.drop_double_walls();
  topology.require_closed(what);
  const std::vector<uvec3> as_given = solid.triangles;
  std::vector<Patch> patches = topology.orient(what);
  orient_shells(solid, std::move(patches), topology.junctions(), what);
  for (std::size_t t = 0; t < as_given.size(); ++t) done.flipped_triangles += as_given[t] != solid.triangles[t];
  solid = union_surface(solid, what, &done.inner_triangles);
  if (repairs) *repairs = done;
  return solid;
}

double enclosed_volume(const Mesh& solid) {
  std::vector<unsigned> all(solid.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return signed_volume(solid, all);
}

}  // namespace penumbra
