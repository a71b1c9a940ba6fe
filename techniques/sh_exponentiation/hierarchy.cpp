#include "techniques/sh_exponentiation/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

namespace penumbra::sh_exponentiation {

SphereSet without_covered(const SphereSet& set, std::size_t& dropped) {
  std::vector<Sphere> sorted = set.spheres;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Sphere& a, const Sphere& b) { return a.radius > b.radius; });
  SphereSet kept;
  for (const Sphere& s : sorted)
    if (s.radius > 0.0f && std::none_of(kept.spheres.begin(), kept.spheres.end(), [&](const Sphere& other) {
          return glm::length(s.centre - other.centre) + s.radius <= other.radius;
        }))
      kept.spheres.push_back(s);
  dropped = set.size() - kept.size();
  return kept;
}

namespace {

/// A sphere around spheres: about the middle of their box.
Sphere sphere_around(std::vector<Sphere>::const_iterator begin, std::vector<Sphere>::const_iterator end) {
  const Bounds box = bounds(SphereSet{{begin, end}});
  Sphere out{box.centre(), 0.0f};
  for (auto s = begin; s != end; ++s)
    out.radius = std::max(out.radius, glm::length(s->centre - out.centre) + s->radius);
  return out;
}

/// Both sides of the median along the longest axis of the centres.
std::vector<Sphere>::iterator halve(std::vector<Sphere>::iterator begin, std::vector<Sphere>::iterator end) {
  vec3 low(begin->centre), high(begin->centre);
  for (auto s = begin; s != end; ++s) low = glm::min(low, s->centre), high = glm::max(high, s->centre);
  const vec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const auto middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [&](const Sphere& a, const Sphere& b) {
    return std::tie(a.centre[axis], a.radius) < std::tie(b.centre[axis], b.radius);
  });
  return middle;
}

}  // namespace

SphereTree::SphereTree(const SphereSet& set) {
  std::vector<Sphere> spheres = set.spheres;
  if (spheres.empty()) return;
  nodes_.push_back({});
  split(0, spheres.begin(), spheres.end());
}

void SphereTree::split(int node, std::vector<Sphere>::iterator begin, std::vector<Sphere>::iterator end) {
  if (end - begin == 1) {
    nodes_[node] = {*begin, 0, 0};
    return;
  }
  const auto middle = halve(begin, end);
  std::vector<std::vector<Sphere>::iterator> cuts = {begin};
  if (middle - begin > 1) cuts.push_back(halve(begin, middle));
  cuts.push_back(middle);
  if (end - middle > 1) cuts.push_back(halve(middle, end));
  cuts.push_back(end);
  const int first = int(nodes_.size()), count = int(cuts.size()) - 1;
  nodes_[node] = {sphere_around(begin, end), first, count};
  nodes_.resize(nodes_.size() + std::size_t(count));
  for (int k = 0; k < count; ++k) split(first + k, cuts[k], cuts[k + 1]);
}

namespace {

/// Is the sphere's angular radius at least that of `sine`, seen from the nearest point of the cluster?
bool looks_large(const Sphere& bound, const Sphere& from, float sine) {
  return bound.radius >= sine * (glm::length(bound.centre - from.centre) - from.radius);
}

/// Adds the logarithm of a sphere's visibility from a point, per band and m.
template <int order>
void add_logarithm(const LogTable& table, const Sphere& sphere, vec3 from, float* f) {
  const vec3 to = sphere.centre - from;
  const float distance = glm::length(to), sine = std::min(1.0f, sphere.radius / distance);
  float y[order * order];
  sh::evaluate<order>(to / distance, y);
  for (int l = 0; l < order; ++l) {
    const auto zonal = float(table.look_up(l, std::sqrt(1.0 - double(sine * sine))));
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i) f[i] += zonal * y[i];
  }
}

}  // namespace

template <int order>
void SphereTree::weigh(const LogTable& table, int node, vec3 centre, WeightedSphere& out) const {
  float parent[order * order] = {}, sum[order * order] = {};
  add_logarithm<order>(table, nodes_[node].bound, centre, parent);
  const float fine = std::sin(glm::radians(20.0f / order));
  std::vector<int> open = {node};
  while (!open.empty()) {
    const Node& at = nodes_[open.back()];
    open.pop_back();
    if (at.children == 0 || !looks_large(at.bound, {centre, 0.0f}, fine))
      add_logarithm<order>(table, at.bound, centre, sum);
    else
      for (int k = 0; k < at.children; ++k) open.push_back(at.first_child + k);
  }
  out.sphere = nodes_[node].bound;
  out.bound = true;
  for (int l = 0; l < order; ++l) {
    float cross = 0.0f, square = 0.0f;
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i)
      cross += parent[i] * sum[i], square += parent[i] * parent[i];
    out.weight[l] = square > 0.0f ? cross / square : 1.0f;
  }
}

void SphereTree::cut(const LogTable& table, const Sphere& cluster, std::vector<WeightedSphere>& out) const {
  out.clear();
  if (nodes_.empty()) return;
  const float coarse = std::sin(glm::radians(80.0f / float(table.order())));
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int node = open.back();
    const Node& at = nodes_[node];
    open.pop_back();
    if (at.children > 0 && looks_large(at.bound, cluster, coarse)) {
      for (int k = 0; k < at.children; ++k) open.push_back(at.first_child + k);
      continue;
    }
    out.push_back({at.bound});
    if (at.children > 0)
      sh::with_order<4, 6>(table.order(), [&](auto n) { weigh<n>(table, node, cluster.centre, out.back()); });
  }
}

float cell_edge(const SphereSet& set, const Sphere& bound) {
  float largest = 0.0f;
  for (const Sphere& s : set.spheres) largest = std::max(largest, s.radius);
  return largest > 0.0f ? largest * std::exp2(std::round(std::log2(bound.radius / (5.0f * largest)))) : 1.0f;
}

std::vector<Cluster> make_clusters(const Receivers& receivers, float edge) {
  constexpr float within =
      0.37f;  // where in its cell the first receiver lies: those in line with it keep off the walls
  std::map<std::tuple<int, int, int>, std::size_t> found;
  std::vector<Cluster> clusters;
  int first = 0;
  while (first < receivers.size() && !receivers.valid(first)) ++first;
  for (int i = first; i < receivers.size(); ++i) {
    if (!receivers.valid(i)) continue;
    const vec3 zero = receivers.position[first] - within * edge;
    vec3 cell = glm::floor((receivers.position[i] - zero) / edge);
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(cell[c]) < 1e9f)) cell[c] = 1e9f;  // too far away, or not a number
    const auto [at, fresh] = found.try_emplace({int(cell.x), int(cell.y), int(cell.z)}, clusters.size());
    if (fresh) clusters.push_back({{zero + (cell + 0.5f) * edge, 0.5f * std::sqrt(3.0f) * edge}, {}});
    clusters[at->second].receivers.push_back(i);
  }
  return clusters;
}

}  // namespace penumbra::sh_exponentiation
