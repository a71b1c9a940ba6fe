#include "scenes/import/raw_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scenes/error.h"
#include "scenes/import/polygon.h"
#include "scenes/import/turn.h"

namespace penumbra {
namespace {

/// Numbers for equal keys: an open-addressing table, since a mesh asks for every corner.
template <class Key, class Hash>
class Numbering {
 public:
  explicit Numbering(std::size_t expected) : table_(std::bit_ceil(2 * expected + 16), empty) {}

  /// The number of a key: that of its first appearance if it is there already, else `fresh`.
  unsigned number(const Key& key, unsigned fresh) {
    if (2 * keys_.size() >= table_.size()) grow();
    std::size_t slot = Hash()(key) & (table_.size() - 1);
    for (; table_[slot] != empty; slot = (slot + 1) & (table_.size() - 1))
      if (keys_[table_[slot]] == key) return numbers_[table_[slot]];
    table_[slot] = static_cast<unsigned>(keys_.size());
    keys_.push_back(key);
    numbers_.push_back(fresh);
    return fresh;
  }

 private:
  static constexpr unsigned empty = std::numeric_limits<unsigned>::max();

  void grow() {
    table_.assign(2 * table_.size(), empty);
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      std::size_t slot = Hash()(keys_[k]) & (table_.size() - 1);
      while (table_[slot] != empty) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = static_cast<unsigned>(k);
    }
  }

  std::vector<unsigned> table_;
  std::vector<Key> keys_;
  std::vector<unsigned> numbers_;
};

std::uint64_t mixed(std::uint64_t h, std::uint64_t bits) {  // a round of MurmurHash3's 64-bit finaliser
  h ^= bits;
  h *= 0xff51afd7ed558ccdull;
  return h ^ h >> 33;
}

struct PositionHash {
  std::size_t operator()(const dvec3& p) const {
    std::uint64_t h = 0x9e3779b97f4a7c15ull;
    for (int c = 0; c < 3; ++c) h = mixed(h, std::bit_cast<std::uint64_t>(p[c] + 0.0));  // -0 + 0 = 0
    return mixed(h, 0);
  }
};

struct PlaceAndNormal {
  unsigned place;
  vec3 normal;
  bool operator==(const PlaceAndNormal&) const = default;
};

struct PlaceAndNormalHash {
  std::size_t operator()(const PlaceAndNormal& v) const {
    std::uint64_t h = mixed(0x9e3779b97f4a7c15ull, v.place);
    for (int c = 0; c < 3; ++c) h = mixed(h, std::bit_cast<std::uint32_t>(v.normal[c] + 0.0f));
    return mixed(h, 0);
  }
};

bool finite(dvec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Leaves triangles with three different places.
void drop_degenerate(RawMesh& raw, const std::vector<unsigned>& place, const std::string& path) {
  for (const RawTriangle& t : raw.triangles)
    for (const Corner& corner : t.corners) {
      const dvec3& p = raw.positions[corner.position];
      if (!finite(p))
        throw Error("{}: vertex {} is not finite ({}, {}, {}); repair the mesh and save it again", path,
                    corner.position, p.x, p.y, p.z);
    }
  std::erase_if(raw.triangles, [&](const RawTriangle& t) {
    const unsigned a = place[t.corners[0].position], b = place[t.corners[1].position], c = place[t.corners[2].position];
    return a == b || b == c || c == a;
  });
}

void say_precision(const RawMesh& raw, const ImportedMesh& mesh, const std::string& path, Outbox& says) {
  dvec3 low = mesh.positions[0], high = low;
  for (const dvec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
  const dvec3 extent = high - low;
  const double size = std::max({extent.x, extent.y, extent.z});
  if (!(raw.spacing / 2.0 > 1e-4 * size)) return;
  says.warn(fmt::format(
      "{}: coordinates are so far from zero that single precision moves them by up to {:.2g} of the file's units, "
      "{:.2g} % of the mesh; save it as OBJ or PLY with all digits, or nearer to zero",
      path, raw.spacing / 2.0, 50.0 * raw.spacing / size));
}

}  // namespace

void RawMesh::add_polygon(std::span<const Corner> corners, bool file_normals, bool mirrored) {
  const auto add = [&](Corner a, Corner b, Corner c) {
    triangles.push_back(mirrored ? RawTriangle{{a, c, b}, file_normals} : RawTriangle{{a, b, c}, file_normals});
  };
  if (corners.size() == 3) return add(corners[0], corners[1], corners[2]);
  std::vector<dvec3> points;
  points.reserve(corners.size());
  for (const Corner& corner : corners) points.push_back(positions[corner.position]);
  for (const auto& t : triangulate(points)) add(corners[t[0]], corners[t[1]], corners[t[2]]);
}

void RawMesh::make_flat(RawTriangle& triangle) {
  auto& [a, b, c] = triangle.corners;
  const dvec3 corner = positions[a.position];
  a.normal = b.normal = c.normal = static_cast<unsigned>(normals.size());
  normals.push_back(glm::cross(positions[b.position] - corner, positions[c.position] - corner));
}

double float_spacing(std::span<const dvec3> positions) {
  double largest = 0.0;
  for (const dvec3& p : positions)
    if (finite(p)) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest > 0.0 ? std::ldexp(1.0, std::ilogb(largest) - 23) : 0.0;
}

std::vector<unsigned> equal_places(const std::vector<dvec3>& positions) {
  Numbering<dvec3, PositionHash> places(positions.size());
  std::vector<unsigned> out;
  out.reserve(positions.size());
  for (const dvec3& p : positions) out.push_back(places.number(p, static_cast<unsigned>(out.size())));
  return out;
}

dvec3 unit_or_zero(dvec3 normal) {
  const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  return finite(normal) && largest > 0.0 ? glm::normalize(normal / largest) : dvec3(0.0);
}

ImportedMesh assemble(RawMesh raw, const std::string& path, Outbox& says) {
  if (raw.positions.size() > no_normal / 4)
    throw Error("{}: too many vertices ({}); simplify the mesh", path, raw.positions.size());
  const std::vector<unsigned> place = equal_places(raw.positions);
  drop_degenerate(raw, place, path);
  if (raw.triangles.empty())
    throw Error("{}: the mesh has no triangles; give a surface of faces, not points, lines or curves", path);
  turn_to_normals(raw, place, path, says);

  ImportedMesh mesh;
  Numbering<PlaceAndNormal, PlaceAndNormalHash> vertices(raw.positions.size());
  std::vector<Corner> latest(raw.positions.size(), {no_normal, no_normal});  // vertex and normal that a position had
  bool has_normals = false;
  for (const RawTriangle& t : raw.triangles) {
    uvec3 triangle;
    for (int k = 0; k < 3; ++k) {
      const Corner corner = t.corners[std::size_t(k)];
      Corner& known = latest[corner.position];
      if (known.position == no_normal || known.normal != corner.normal) {
        const vec3 normal = corner.normal == no_normal ? vec3(0.0f) : vec3(unit_or_zero(raw.normals[corner.normal]));
        const auto fresh = static_cast<unsigned>(mesh.positions.size());
        known = {vertices.number({place[corner.position], normal}, fresh), corner.normal};
        if (known.position == fresh) {
          mesh.positions.push_back(raw.positions[corner.position]);
          mesh.normals.push_back(normal);
        }
        has_normals |= normal != vec3(0.0f);
      }
      triangle[k] = known.position;
    }
    mesh.triangles.push_back(triangle);
  }
  if (!has_normals) mesh.normals.clear();
  say_precision(raw, mesh, path, says);
  return mesh;
}

}  // namespace penumbra
