// Fewer spheres for receivers that are far away: a tree of bounding spheres, cut where they look small (Ren et al.
// 2006).
#pragma once

#include <vector>

#include "scenes/receivers.h"
#include "scenes/sphere_set.h"
#include "techniques/sh_exponentiation/exponential.h"

namespace penumbra::sh_exponentiation {

/// A sphere, and what its logarithm is multiplied by, band by band.
struct WeightedSphere {
  Sphere sphere;
  float weight[6] = {1, 1, 1, 1, 1, 1};
  bool bound = false;  ///< of several: the self-shadow rule does not replace it
};

/// The set without spheres that lie inside another one: they block nothing, but would multiply the visibility once
/// more. `dropped` counts them. Equal spheres: the first stays.
SphereSet without_covered(const SphereSet& set, std::size_t& dropped);

class SphereTree {
 public:
  SphereTree() = default;
  /// Nodes have up to four children, split at medians along the longest axis.
  explicit SphereTree(const SphereSet& set);

  /// Spheres that stand for all of the set, seen from anywhere within `cluster`: nodes of an angular radius below
  /// 80 / order degrees. Band l of a node is weighted by sum_m f^p f^d / sum_m (f^p)^2 (1 for 0/0), where p is its own
  /// logarithm and d the sum of those of its descendants below 20 / order degrees, seen from the cluster's centre.
  void cut(const LogTable& table, const Sphere& cluster, std::vector<WeightedSphere>& out) const;

  const Sphere& bound() const { return nodes_[0].bound; }
  bool empty() const { return nodes_.empty(); }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

 private:
  struct Node {
    Sphere bound;
    int first_child, children;  ///< none: the bound is a sphere of the set
  };
  void split(int node, std::vector<Sphere>::iterator begin, std::vector<Sphere>::iterator end);
  template <int order>
  void weigh(const LogTable& table, int node, vec3 centre, WeightedSphere& out) const;

  std::vector<Node> nodes_;
};

/// Valid receivers that lie in the same cell of a grid.
struct Cluster {
  Sphere bound;
  std::vector<int> receivers;
};

/// Cells have as edge a power of two times the largest radius, about a fifth of that of the bound around all, so that
/// they stay when spheres move a little, and are alike at any unit.
float cell_edge(const SphereSet& set, const Sphere& bound);
/// The grid is counted from the first valid receiver: where the scene lies does not matter.
std::vector<Cluster> make_clusters(const Receivers& receivers, float edge);

}  // namespace penumbra::sh_exponentiation
