#include "scenes/fit/shells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "scenes/error.h"
#include "scenes/fit/disjoint_sets.h"
#include "scenes/fit/triangle_tree.h"

namespace penumbra {
namespace {

void turn(Mesh& mesh, const std::vector<unsigned>& triangles) {
  for (const unsigned t : triangles) std::swap(mesh.triangles[t].y, mesh.triangles[t].z);
}

/// A closed surface whose triangles agree.
struct Shell {
  std::vector<unsigned> triangles;
  bool as_given = true;
  double volume = 0.0;
  std::vector<int> around{};  ///< shells that hold all of it
};

class Shells {
 public:
  Shells(Mesh& mesh, std::vector<Patch> patches, Junctions junctions, const std::string& what)
      : mesh_(mesh),
        what_(what),
        patches_(std::move(patches)),
        patch_of_(mesh.triangles.size()),
        junctions_(std::move(junctions)) {
    for (unsigned p = 0; p < patches_.size(); ++p)
      for (const unsigned t : patches_[p].triangles) patch_of_[t] = p;
  }

  void orient() {
    turn_contradictions();
    for (const auto& [edge, triangles] : junctions_) {
      if (balance(edge, triangles) == 0) continue;
      const vec3 p = mesh_.positions[edge.first];
      throw Error("{}: {} triangles meet at an edge at ({:.4g}, {:.4g}, {:.4g}) and no orientation fits all of them",
                  what_, triangles.size(), p.x, p.y, p.z);
    }
    std::vector<Shell> shells = close_shells();
    find_nesting(shells);
    face(shells);
  }

 private:
  /// Does the triangle walk the edge from its lower to its higher vertex?
  bool forward(const Edge& edge, unsigned triangle) const {
    const uvec3& t = mesh_.triangles[triangle];
    for (int k = 0; k < 3; ++k)
      if (t[k] == edge.first && t[(k + 1) % 3] == edge.second) return true;
    return false;
  }

  int balance(const Edge& edge, const std::vector<unsigned>& triangles) const {
    int sum = 0;
    for (const unsigned t : triangles) sum += forward(edge, t) ? 1 : -1;
    return sum;
  }

  /// Patches that meet at an edge which does not balance, and all that meet those, are turned towards where an even
  /// number of them lies ahead.
  void turn_contradictions() {
    DisjointSets groups(patches_.size());
    for (const auto& [edge, triangles] : junctions_)
      for (const unsigned t : triangles) groups.join(patch_of_[triangles[0]], patch_of_[t]);
    std::vector<char> contradicts(patches_.size());
    bool any = false;
    for (const auto& [edge, triangles] : junctions_)
      if (balance(edge, triangles) != 0) contradicts[groups.of(patch_of_[triangles[0]])] = 1, any = true;
    if (!any) return;
    const TriangleTree tree(mesh_);
    std::vector<unsigned> wrong;
    for (unsigned p = 0; p < patches_.size(); ++p) {
      const unsigned group = groups.of(p);
      if (!contradicts[group]) continue;
      patches_[p].as_given = false;
      if (odd_ahead(tree, widest(tree, patches_[p].triangles),
                    [&](unsigned t) { return groups.of(patch_of_[t]) == group; }))
        wrong.push_back(p);
    }
    for (const unsigned p : wrong) turn(mesh_, patches_[p].triangles);
  }

  static unsigned widest(const TriangleTree& tree, const std::vector<unsigned>& triangles) {
    const auto area2 = [&](unsigned t) {
      const TriangleTree::Corners& c = tree.corners(t);
      const dvec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
      return glm::dot(n, n);
    };
    return *std::max_element(triangles.begin(), triangles.end(),
                             [&](unsigned a, unsigned b) { return area2(a) < area2(b); });
  }

  static dvec3 middle(const TriangleTree& tree, unsigned t) {
    const TriangleTree::Corners& c = tree.corners(t);
    return (c[0] + c[1] + c[2]) / 3.0;
  }

  /// Does an odd number of the counted triangles lie ahead of triangle t? Those that coincide with it lie on each other
  /// in the order of their numbers, seen from one side.
  template <class Counts>
  static bool odd_ahead(const TriangleTree& tree, unsigned t, Counts counts) {
    const bool rising = glm::dot(tree.normal(t), dvec3(0.48, 0.6, 0.64)) > 0.0;
    int ahead = 0;
    for (const TriangleTree::Meeting& m : tree.meetings(middle(tree, t), tree.normal(t)))
      if (counts(m.triangle)) ahead += m.on ? (rising ? m.triangle > t : m.triangle < t) : 1;
    return ahead % 2 != 0;
  }

  /// Joins the patches that bound the same stuff at an edge: going round it, where one opens the next one closes.
  std::vector<Shell> close_shells() {
    DisjointSets sets(patches_.size());
    for (const auto& [edge, triangles] : junctions_) {
      std::vector<unsigned> open;
      const std::vector<unsigned> ring = around(edge, triangles);
      for (int turn = 0; turn < 2; ++turn)
        for (const unsigned t : ring) {
          if (!forward(edge, t)) {
            if (turn == 0) open.push_back(t);
          } else if (!open.empty()) {
            sets.join(patch_of_[open.back()], patch_of_[t]);
            open.pop_back();
          }
        }
    }
    std::map<unsigned, Shell> by_set;
    for (unsigned p = 0; p < patches_.size(); ++p) {
      Shell& shell = by_set[sets.of(p)];
      shell.triangles.insert(shell.triangles.end(), patches_[p].triangles.begin(), patches_[p].triangles.end());
      shell.as_given = shell.as_given && patches_[p].as_given;
    }
    std::vector<Shell> shells;
    for (auto& [set, shell] : by_set) {
      shell.volume = signed_volume(mesh_, shell.triangles);
      shells.push_back(std::move(shell));
    }
    return shells;
  }

  /// Triangles by their angle about an edge; of those at one angle the forward ones, which end what lies before them,
  /// come first. Copies are in such an order that at all their edges the same ones belong together.
  std::vector<unsigned> around(const Edge& edge, const std::vector<unsigned>& triangles) const {
    const dvec3 low = mesh_.positions[edge.first];
    const dvec3 axis = glm::normalize(dvec3(mesh_.positions[edge.second]) - low);
    const auto away = [&](unsigned t) {
      const uvec3& v = mesh_.triangles[t];
      const unsigned apex = v.x != edge.first && v.x != edge.second   ? v.x
                            : v.y != edge.first && v.y != edge.second ? v.y
                                                                      : v.z;
      const dvec3 d = dvec3(mesh_.positions[apex]) - low;
      return d - glm::dot(d, axis) * axis;
    };
    const dvec3 start = away(triangles[0]), side = glm::cross(axis, start);
    struct Spoke {
      long long angle;
      bool opens;
      unsigned triangle;
    };
    std::vector<Spoke> spokes;
    for (const unsigned t : triangles) {
      const dvec3 d = away(t);
      double angle = std::atan2(glm::dot(d, side), glm::dot(d, start));
      if (angle < -1e-9) angle += 2.0 * pi;
      spokes.push_back({std::llround(angle * 1e9), !forward(edge, t), t});
    }
    std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
      if (a.angle != b.angle) return a.angle < b.angle;
      if (a.opens != b.opens) return b.opens;
      return a.opens ? a.triangle > b.triangle : a.triangle < b.triangle;
    });
    std::vector<unsigned> order;
    order.reserve(order.size() + spokes.size());
    for (const Spoke& s : spokes) order.push_back(s.triangle);
    return order;
  }

  /// Finds, for every shell, the larger ones that hold all of it, borders included.
  void find_nesting(std::vector<Shell>& shells) const {
    if (shells.size() < 2) return;
    const TriangleTree tree(mesh_);
    std::vector<int> shell_of(mesh_.triangles.size());
    for (std::size_t s = 0; s < shells.size(); ++s)
      for (const unsigned t : shells[s].triangles) shell_of[t] = int(s);
    for (std::size_t s = 0; s < shells.size(); ++s) {
      Shell& shell = shells[s];
      constexpr std::size_t looks = 32;
      const std::size_t step = std::max<std::size_t>(1, shell.triangles.size() / looks);
      for (std::size_t i = 0; i < shell.triangles.size(); i += step) {
        std::vector<int> holding = holds(tree, shell_of, shell.triangles[i]);
        if (i > 0) {
          std::vector<int> both;
          std::set_intersection(holding.begin(), holding.end(), shell.around.begin(), shell.around.end(),
                                std::back_inserter(both));
          holding = std::move(both);
        }
        shell.around = std::move(holding);
        if (shell.around.empty()) break;
      }
      std::erase_if(shell.around,
                    [&](int other) { return std::abs(shells[other].volume) <= std::abs(shell.volume) * (1.0 + 1e-6); });
    }
  }

  /// Shells in or on which the middle of triangle t lies, in order.
  static std::vector<int> holds(const TriangleTree& tree, const std::vector<int>& shell_of, unsigned t) {
    std::map<int, int> winding;
    std::vector<int> found;
    for (const TriangleTree::Meeting& m : tree.meetings(middle(tree, t), tree.normal(t))) {
      if (m.on) found.push_back(shell_of[m.triangle]);
      else winding[shell_of[m.triangle]] += m.sign;
    }
    for (const auto& [shell, turns] : winding)
      if (turns != 0) found.push_back(shell);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Turns shells, the larger before those inside them.
  void face(const std::vector<Shell>& shells) {
    const auto size = [&](int s) { return std::abs(shells[s].volume); };
    std::vector<int> order(shells.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) > size(b); });
    std::vector<bool> outward(shells.size(), true);
    for (const int s : order) {
      const Shell& shell = shells[s];
      if (!shell.around.empty()) {
        const int holder = *std::min_element(shell.around.begin(), shell.around.end(),
                                             [&](int a, int b) { return size(a) < size(b); });
        const bool alike = (shell.volume > 0.0) == (shells[holder].volume > 0.0);
        outward[s] =
            shell.as_given && shells[holder].as_given ? outward[holder] == alike : shell.around.size() % 2 == 0;
      }
      if (shell.volume != 0.0 && (shell.volume > 0.0) != outward[s]) turn(mesh_, shell.triangles);
    }
  }

  Mesh& mesh_;
  const std::string& what_;
  std::vector<Patch> patches_;
  std::vector<unsigned> patch_of_;
  Junctions junctions_;
};

}  // namespace

void orient_shells(Mesh& mesh, std::vector<Patch> patches, Junctions junctions, const std::string& what) {
  Shells(mesh, std::move(patches), std::move(junctions), what).orient();
}

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

}  // namespace penumbra
