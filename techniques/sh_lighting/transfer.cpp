#include "techniques/sh_lighting/transfer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
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

/// A bit for each direction of a set.
using Bits = std::vector<std::uint32_t>;

bool bit(const std::uint32_t* bits, int j) {
  return (bits[j / 32] >> (j % 32) & 1u) != 0;
}

/// Calls look_at(j) for every bit that is set, in order.
template <class LookAt>
void for_bits(const std::uint32_t* bits, std::size_t words, const LookAt& look_at) {
  for (std::size_t word = 0; word < words; ++word)
    for (std::uint32_t left = bits[word]; left != 0; left &= left - 1) look_at(int(32 * word) + std::countr_zero(left));
}

/// Up to 16 neighbours whose rays are traced together.
struct Tile {
  int which[RayPacket::size], count = 0;
};

/// Valid receivers in tiles of 4 x 4, or of 16 in a row where there are not four rows.
std::vector<Tile> tiles_of(const Receivers& receivers) {
  const int down = receivers.height < 4 ? 1 : 4, along = RayPacket::size / down;
  std::vector<Tile> tiles;
  for (int y0 = 0; y0 < receivers.height; y0 += down)
    for (int x0 = 0; x0 < receivers.width; x0 += along) {
      Tile tile;
      for (int y = y0; y < std::min(receivers.height, y0 + down); ++y)
        for (int x = x0; x < std::min(receivers.width, x0 + along); ++x)
          if (const int i = y * receivers.width + x; receivers.valid(i)) tile.which[tile.count++] = i;
      if (tile.count) tiles.push_back(tile);
    }
  return tiles;
}

/// Directions above the receiver's horizon that the mesh blocks, one ray after the other.
void find_blocked(const RayScene& rays, const DirectionSet& set, const Receivers& receivers, int i,
                  std::uint32_t* blocked) {
  const vec3 from = receivers.ray_origin(i);
  for (int j = 0; j < int(set.directions.size()); ++j)
    if (glm::dot(set.directions[j], receivers.normal[i]) > 0.0f &&
        rays.occluded(from, set.directions[j], std::numeric_limits<float>::infinity()))
      blocked[j / 32] |= 1u << (j % 32);
}

/// The same for a tile: all rays in one direction, and then those in the next.
void find_blocked(const RayScene& rays, const DirectionSet& set, const Receivers& receivers, const Tile& tile,
                  std::uint32_t* const* blocked) {
  struct Ray {
    int receiver, direction;
  };
  vec3 from[RayPacket::size], normal[RayPacket::size];
  for (int k = 0; k < tile.count; ++k) {
    from[k] = receivers.ray_origin(tile.which[k]);
    normal[k] = receivers.normal[tile.which[k]];
  }
  auto queue = make_ray_queue<Ray>(rays, [&](Ray ray, bool hit) {
    if (hit) blocked[ray.receiver][ray.direction / 32] |= 1u << (ray.direction % 32);
  });
  for (int j = 0; j < int(set.directions.size()); ++j) {
    const vec3 direction = set.directions[j];
    for (int k = 0; k < tile.count; ++k)
      if (glm::dot(direction, normal[k]) > 0.0f)
        queue.push({k, j}, from[k], direction, std::numeric_limits<float>::infinity());
  }
  queue.flush();
}

class Gatherer {
 public:
  Gatherer(const Request& request, const DirectionSet& set, const RayScene& rays, const Receivers& receivers,
           const Reflecting* reflecting)
      : request_(request), set_(set), rays_(rays), receivers_(receivers), reflecting_(reflecting) {}

  /// The vectors of one receiver, `channels` rows from `out`; `blocked`: bits of the directions above its horizon.
  void gather(int i, int channels, const std::uint32_t* blocked, float* out) const {
    const vec3 normal = receivers_.normal[i];
    const bool complement = request_.estimator == Estimator::complement;
    if (complement) add_lobe(normal, out);
    std::vector<int> chosen;  // directions to subtract (complement) or to add (plain)
    std::vector<Bounce> bounces;
    if (complement || reflecting_)
      for_bits(blocked, words_of(set_), [&](int j) {
        if (complement) chosen.push_back(j);
        if (reflecting_) add_bounce(i, j, bounces);
      });
    if (!complement)
      for (int j = 0; j < int(set_.directions.size()); ++j)
        if (!bit(blocked, j) && glm::dot(set_.directions[j], normal) > 0.0f) chosen.push_back(j);
    add(normal, chosen, complement ? -set_.weight() : set_.weight(), out);
    for (int c = 1; c < channels; ++c) std::copy(out, out + set_.row, out + c * set_.row);
    if (!bounces.empty()) add_bounces(normal, bounces, out);
  }

  /// The vectors of a tile's receivers.
  void gather(const Tile& tile, TransferVectors& out) const {
    const std::size_t words = words_of(set_);
    Bits bits(words * std::size_t(tile.count), 0u);
    std::uint32_t* own[RayPacket::size];
    for (int k = 0; k < tile.count; ++k) own[k] = &bits[words * std::size_t(k)];
    if (request_.transfer != Transfer::unshadowed) {
      if (request_.packets) find_blocked(rays_, set_, receivers_, tile, own);
      else
        for (int k = 0; k < tile.count; ++k) find_blocked(rays_, set_, receivers_, tile.which[k], own[k]);
    }
    for (int k = 0; k < tile.count; ++k)
      gather(tile.which[k], out.channels, own[k], out.at(std::size_t(tile.which[k])));
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
  out.values.assign(std::size_t(receivers.size()) * out.channels * out.row, 0.0f);
  const Gatherer gatherer(request, set, rays, receivers, reflecting);
  const std::vector<Tile> tiles = tiles_of(receivers);
  tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t t) { gatherer.gather(tiles[t], out); });
  return out;
}

}  // namespace

std::vector<std::uint32_t> blocked_directions(const DirectionSet& set, const RayScene& rays, const Receivers& receivers,
                                              int begin, int end) {
  const std::size_t words = words_of(set);
  Bits bits(std::size_t(end - begin) * words, 0u);
  tbb::parallel_for(begin / RayPacket::size, (end + RayPacket::size - 1) / RayPacket::size, [&](int block) {
    Tile tile;
    std::uint32_t* own[RayPacket::size];
    const int first = std::max(begin, block * RayPacket::size), last = std::min(end, (block + 1) * RayPacket::size);
    for (int i = first; i < last; ++i) {
      if (!receivers.valid(i)) continue;
      own[tile.count] = &bits[std::size_t(i - begin) * words];
      tile.which[tile.count++] = i;
    }
    find_blocked(rays, set, receivers, tile, own);
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
