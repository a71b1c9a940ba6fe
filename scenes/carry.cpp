#include "scenes/carry.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numeric>

namespace penumbra {
namespace {

using glm::dmat3;

std::vector<std::vector<unsigned>> clusters_of(const Mesh& mesh, const SphereSet& set) {
  const auto height = [&](unsigned vertex, const Sphere& s) {
    return glm::distance(mesh.positions[vertex], s.centre) - s.radius;
  };
  std::vector<unsigned> owner(mesh.positions.size());
  tbb::parallel_for(0u, unsigned(owner.size()), [&](unsigned v) {
    float least = std::numeric_limits<float>::max();
    for (unsigned k = 0; k < set.size(); ++k)
      if (const float h = height(v, set.spheres[k]); h < least) least = h, owner[v] = k;
  });
  std::vector<std::vector<unsigned>> clusters(set.size());
  for (unsigned v = 0; v < owner.size(); ++v) clusters[owner[v]].push_back(v);
  for (std::size_t k = 0; k < set.size(); ++k) {
    if (clusters[k].size() >= 4) continue;
    std::vector<unsigned>& nearest = clusters[k];
    nearest.resize(mesh.positions.size());
    std::iota(nearest.begin(), nearest.end(), 0u);
    const std::size_t few = std::min<std::size_t>(12, nearest.size());
    std::partial_sort(nearest.begin(), nearest.begin() + std::ptrdiff_t(few), nearest.end(),
                      [&](unsigned a, unsigned b) { return height(a, set.spheres[k]) < height(b, set.spheres[k]); });
    nearest.resize(few);
  }
  return clusters;
}

/// The rotation that turns a moment matrix, sum of moved * rest^T, most nearly into a symmetric one (Mueller et al.
/// 2016, "A robust method to extract the rotational part of deformations").
dmat3 rotation_of(const dmat3& moment) {
  glm::dquat q(1.0, 0.0, 0.0, 0.0);
  for (int i = 0; i < 60; ++i) {
    const dmat3 r = glm::mat3_cast(q);
    dvec3 turn(0.0);
    double along = 0.0;
    for (int c = 0; c < 3; ++c) turn += glm::cross(r[c], moment[c]), along += glm::dot(r[c], moment[c]);
    turn /= std::abs(along) + 1e-12 * (1.0 + std::abs(along));
    const double angle = glm::length(turn);
    if (angle < 1e-9) break;
    q = glm::normalize(glm::angleAxis(angle, turn / angle) * q);
  }
  return glm::mat3_cast(q);
}

}  // namespace

SphereCarrier::SphereCarrier(const Mesh& rest, const SphereSet& set, Carry carry) : carry_(carry) {
  for (const std::vector<unsigned>& vertices : clusters_of(rest, set)) {
    Cluster& cluster = clusters_.emplace_back();
    dvec3 mean(0.0);
    for (const unsigned v : vertices) mean += dvec3(rest.positions[v]) / double(vertices.size());
    const vec3 centre = set.spheres[clusters_.size() - 1].centre - vec3(mean);
    cluster.centre = centre;
    dmat3 moment(0.0);
    for (const unsigned v : vertices) {
      const dvec3 offset = dvec3(rest.positions[v]) - mean;
      moment += glm::outerProduct(offset, offset);
    }
    // A flat cluster says nothing about the direction across it; a trace of stiffness keeps the inverse finite.
    const double trace = moment[0][0] + moment[1][1] + moment[2][2];
    const dvec3 solved = glm::inverse(moment + dmat3(1e-6 * trace + 1e-30)) * dvec3(centre);
    dvec3 sum(0.0);
    for (const unsigned v : vertices) {
      const vec3 offset = rest.positions[v] - vec3(mean);
      const double weight = 1.0 / double(vertices.size()) + glm::dot(solved, dvec3(offset));
      cluster.members.push_back({v, offset, float(weight)});
      sum += double(float(weight)) * dvec3(rest.positions[v]);
    }
    cluster.rest = vec3(dvec3(set.spheres[clusters_.size() - 1].centre) - sum);
  }
}

void SphereCarrier::move(const Mesh& deformed, SphereSet& out) const {
  tbb::parallel_for(std::size_t(0), clusters_.size(), [&](std::size_t k) {
    const Cluster& cluster = clusters_[k];
    dvec3 sum(0.0);
    if (carry_ == Carry::affine) {
      for (const Member& m : cluster.members) sum += double(m.weight) * dvec3(deformed.positions[m.vertex]);
      out.spheres[k].centre = vec3(sum) + cluster.rest;
      return;
    }
    dmat3 moment(0.0);  // offsets sum to zero, so positions need not be centred
    for (const Member& m : cluster.members) {
      const dvec3 at = deformed.positions[m.vertex];
      sum += at;
      for (int c = 0; c < 3; ++c) moment[c] += double(m.offset[c]) * at;
    }
    const dvec3 mean = sum / double(cluster.members.size());
    out.spheres[k].centre = vec3(mean + rotation_of(moment) * dvec3(cluster.centre));
  });
}

double surface_coverage(const Mesh& mesh, const SphereSet& set) {
  std::vector<double> area(mesh.triangles.size()), covered(mesh.triangles.size());
  tbb::parallel_for(std::size_t(0), area.size(), [&](std::size_t i) {
    const uvec3& t = mesh.triangles[i];
    const vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z], centroid = (a + b + c) / 3.0f;
    area[i] = glm::length(glm::cross(b - a, c - a));
    const bool in = std::any_of(set.spheres.begin(), set.spheres.end(),
                                [&](const Sphere& s) { return glm::distance(centroid, s.centre) <= s.radius; });
    covered[i] = in ? area[i] : 0.0;
  });
  const double all = std::accumulate(area.begin(), area.end(), 0.0);
  return all > 0.0 ? std::accumulate(covered.begin(), covered.end(), 0.0) / all : 1.0;
}

}  // namespace penumbra
