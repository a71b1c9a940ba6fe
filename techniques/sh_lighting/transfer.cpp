#include "techniques/sh_lighting/transfer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "techniques/bases/ray_packets.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/projection.h"
#include "techniques/sh_lighting/kernel.h"

namespace penumbra::sh_lighting {

DirectionSet::DirectionSet(int order_of_basis, int count, std::uint64_t seed)
    : order(order_of_basis), row((sh::coefficients(order) + row_multiple - 1) / row_multiple * row_multiple) {
  const int strata = std::max(1, int(std::lround(std::sqrt(count))));
  const std::vector<dvec3> all = sh::stratified_directions(strata, seed);
  constexpr int tile = 4;
  for (int a0 = 0; a0 < strata; a0 += tile)
    for (int b0 = 0; b0 < strata; b0 += tile)
      for (int a = a0; a < std::min(strata, a0 + tile); ++a)
        for (int b = b0; b < std::min(strata, b0 + tile); ++b) {
          const dvec3 w = all[std::size_t(a) * strata + b];
          directions.emplace_back(w);
          const std::vector<double> y = sh::evaluate(order, w);
          basis.insert(basis.end(), y.begin(), y.end());
          basis.resize(directions.size() * row, 0.0f);
        }
}

namespace {

/// What the points of a mesh reflect: transfer times albedo at its vertices.
struct Reflecting {
  const Mesh* mesh;
  const TransferVectors* vertices;
};

/// Calls done(direction, blocked) for every direction above a receiver's horizon.
template <class Done>
void find_blocked(const RayScene& rays, const DirectionSet& set, const Receivers& receivers, int i, bool packets,
                  Done done) {
  const vec3 normal = receivers.normal[i], from = receivers.ray_origin(i);
  const float far = std::numeric_limits<float>::infinity();
  const auto above = [&](int j) { return glm::dot(set.directions[j], normal) > 0.0f; };
  if (!packets) {
    for (int j = 0; j < int(set.directions.size()); ++j)
      if (above(j)) done(j, rays.occluded(from, set.directions[j], far));
    return;
  }
  auto queue = make_ray_queue<int>(rays, done, true);
  for (int j = 0; j < int(set.directions.size()); ++j)
    if (above(j)) queue.push(j, from, set.directions[j], far);
  queue.flush();
}

class Gatherer {
 public:
  Gatherer(const Request& request, const DirectionSet& set, const RayScene& rays, const Receivers& receivers,
           const Reflecting* reflecting)
      : request_(request), set_(set), rays_(rays), receivers_(receivers), reflecting_(reflecting) {}

  /// The vectors of one receiver, `channels` rows from `out`.
  void gather(int i, int channels, float* out) const {
    const vec3 normal = receivers_.normal[i];
    std::fill(out, out + channels * set_.row, 0.0f);
    if (normal == vec3(0.0f)) return;
    const bool complement = request_.estimator == Estimator::complement;
    if (complement) add_lobe(normal, out);
    std::vector<int> chosen;  // directions to subtract (complement) or to add (plain)
    std::vector<Bounce> bounces;
    if (request_.transfer != Transfer::unshadowed)
      find_blocked(rays_, set_, receivers_, i, request_.packets, [&](int j, bool blocked) {
        if (blocked == complement) chosen.push_back(j);
        if (blocked && reflecting_) add_bounce(i, j, bounces);
      });
    else if (!complement)
      for (int j = 0; j < int(set_.directions.size()); ++j)
        if (glm::dot(set_.directions[j], normal) > 0.0f) chosen.push_back(j);
    add(normal, chosen, complement ? -set_.weight() : set_.weight(), out);
    for (int c = 1; c < channels; ++c) std::copy(out, out + set_.row, out + c * set_.row);
    if (!bounces.empty()) add_bounces(normal, bounces, out);
  }

 private:
  void add_lobe(vec3 normal, float* out) const {
    const std::vector<double> lobe = sh::rotate_zonal(sh::cosine_lobe(set_.order), normal);
    for (std::size_t k = 0; k < lobe.size(); ++k) out[k] = float(lobe[k] / pi);
  }

  /// The mesh reflects from its front; its back is black.
  void add_bounce(int i, int j, std::vector<Bounce>& bounces) const {
    const Hit hit = rays_.intersect(receivers_.ray_origin(i), set_.directions[j]);
    if (!hit || glm::dot(hit.normal, set_.directions[j]) >= 0.0f) return;
    bounces.push_back({j, reflecting_->mesh->triangles[hit.triangle], {1.0f - hit.u - hit.v, hit.u, hit.v}});
  }

  /// out += scale * sum of cos_j Y_j.
  void add(vec3 normal, const std::vector<int>& chosen, float scale, float* out) const {
    if (request_.packets) return add_directions(set_, normal, chosen, scale, out);
    std::vector<double> sum(std::size_t(sh::coefficients(set_.order)), 0.0);
    for (const int j : chosen)
      for (std::size_t k = 0; k < sum.size(); ++k)
        sum[k] += double(glm::dot(set_.directions[j], normal)) * double(set_.basis[std::size_t(j) * set_.row + k]);
    for (std::size_t k = 0; k < sum.size(); ++k) out[k] += float(double(scale) * sum[k]);
  }

  /// out[channel] += weight * sum of cos_j (what the point hit reflects).
  void add_bounces(vec3 normal, const std::vector<Bounce>& bounces, float* out) const {
    if (request_.packets) return sh_lighting::add_bounces(set_, normal, bounces, *reflecting_->vertices, out);
    const std::size_t size = std::size_t(3) * set_.row;
    std::vector<double> sum(size, 0.0);
    for (const Bounce& b : bounces)
      for (int v = 0; v < 3; ++v) {
        const float* row = reflecting_->vertices->at(b.vertex[v]);
        const double weight = double(glm::dot(set_.directions[b.direction], normal)) * double(b.weight[v]);
        for (std::size_t k = 0; k < size; ++k) sum[k] += weight * double(row[k]);
      }
    for (std::size_t k = 0; k < size; ++k) out[k] += float(double(set_.weight()) * sum[k]);
  }

  const Request& request_;
  const DirectionSet& set_;
  const RayScene& rays_;
  const Receivers& receivers_;
  const Reflecting* reflecting_;
};

TransferVectors gather_all(const Request& request, const DirectionSet& set, const RayScene& rays,
                           const Receivers& receivers, const Reflecting* reflecting) {
  TransferVectors out;
  out.channels = request.transfer == Transfer::interreflected ? 3 : 1;
  out.row = set.row;
  out.values.resize(std::size_t(receivers.size()) * out.channels * out.row);
  const Gatherer gatherer(request, set, rays, receivers, reflecting);
  const auto one = [&](int i) { gatherer.gather(i, out.channels, out.at(std::size_t(i))); };
  if (request.packets) tbb::parallel_for(0, receivers.size(), one);
  else
    for (int i = 0; i < receivers.size(); ++i) one(i);
  return out;
}

}  // namespace

std::vector<std::uint32_t> blocked_directions(const DirectionSet& set, const RayScene& rays, const Receivers& receivers,
                                              int begin, int end) {
  const std::size_t words = words_of(set);
  std::vector<std::uint32_t> bits(std::size_t(end - begin) * words, 0u);
  tbb::parallel_for(begin, end, [&](int i) {
    if (!receivers.valid(i)) return;
    std::uint32_t* own = &bits[std::size_t(i - begin) * words];
    find_blocked(rays, set, receivers, i, true, [&](int j, bool blocked) {
      if (blocked) own[j / 32] |= 1u << (j % 32);
    });
  });
  return bits;
}

TransferVectors compute_transfer(const Request& request, const DirectionSet& set, const RayScene& rays,
                                 const Mesh& mesh, const Receivers& receivers) {
  if (request.transfer != Transfer::interreflected || request.bounces == 0 || mesh.empty())
    return gather_all(request, set, rays, receivers, nullptr);
  const Receivers vertices = make_receivers({MeshVertices{}, vec3(1.0f)}, mesh);
  TransferVectors at_vertices;
  for (int bounce = 0; bounce < request.bounces; ++bounce) {
    const Reflecting before{&mesh, &at_vertices};
    TransferVectors next = gather_all(request, set, rays, vertices, bounce == 0 ? nullptr : &before);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < next.row; ++k) next.at(v, c)[k] *= request.mesh_albedo[c];
    at_vertices = std::move(next);
  }
  const Reflecting last{&mesh, &at_vertices};
  return gather_all(request, set, rays, receivers, &last);
}

}  // namespace penumbra::sh_lighting
