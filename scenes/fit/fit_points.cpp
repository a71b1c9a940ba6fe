#include "scenes/fit/fit_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>

namespace penumbra {
namespace {

/// Cells are named by one number; 2^20 a side are enough for a lattice of 512.
struct Lattice {
  dvec3 low;
  double spacing;
  std::int64_t key(vec3 p) const {
    std::int64_t k = 0;
    for (int c = 2; c >= 0; --c) k = (k << 20) + std::int64_t(std::floor((p[c] - low[c]) / spacing)) + 1;
    return k;
  }
  static std::int64_t offset(int x, int y, int z) {
    return ((std::int64_t(z) << 20) + y) * (std::int64_t(1) << 20) + x;
  }
};

/// Midpoints and centroids, until no edge is longer than `spacing`.
void sample_triangle(vec3 a, vec3 b, vec3 c, float spacing, std::vector<vec3>& out) {
  out.push_back((a + b + c) / 3.0f);
  if (std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)}) <= spacing) return;
  const vec3 ab = 0.5f * (a + b), bc = 0.5f * (b + c), ca = 0.5f * (c + a);
  for (const vec3& p : {ab, bc, ca}) out.push_back(p);
  sample_triangle(a, ab, ca, spacing, out), sample_triangle(ab, b, bc, spacing, out);
  sample_triangle(ca, bc, c, spacing, out), sample_triangle(bc, ca, ab, spacing, out);
}

/// Keeps the first point of every cell.
void thin(std::vector<vec3>& points, const Lattice& lattice) {
  std::unordered_set<std::int64_t> taken;
  std::erase_if(points, [&](vec3 p) { return !taken.insert(lattice.key(p)).second; });
}

}  // namespace

std::vector<vec3> interior_points(const SolidRows& rows, double spacing) {
  std::vector<vec3> points;
  const dvec3 low = rows.box().low, extent = rows.box().extent();
  const auto cells = [&](int c) { return std::max(1, int(std::ceil(extent[c] / spacing - 1e-6))); };
  const int nx = cells(0), ny = cells(1), nz = cells(2);
  const dvec3 start = low + 0.5 * (extent - spacing * dvec3(nx, ny, nz));
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const vec3 p(start + spacing * dvec3(x + 0.5, y + 0.5, z + 0.5));
        if (rows.inside(p)) points.push_back(p);
      }
  return points;
}

FitPoints sample_points(const Mesh& solid, const SolidRows& rows, double spacing) {
  std::vector<vec3> all = solid.positions;
  all.reserve(all.size() + solid.triangles.size());
  for (const uvec3& t : solid.triangles)
    sample_triangle(solid.positions[t.x], solid.positions[t.y], solid.positions[t.z], float(spacing), all);
  thin(all, {rows.box().low, 0.5 * spacing});
  const std::vector<vec3> interior = interior_points(rows, spacing);
  all.insert(all.end(), interior.begin(), interior.end());

  const Lattice lattice{rows.box().low, spacing};
  std::vector<std::int64_t> key(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) key[i] = lattice.key(all[i]);
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key[a] < key[b]; });

  FitPoints points;
  std::vector<std::int64_t> cells;
  points.position.reserve(all.size());
  for (const int i : order) {
    if (cells.empty() || cells.back() != key[i]) cells.push_back(key[i]), points.first.push_back(points.size());
    points.position.push_back(all[i]);
  }
  points.first.push_back(points.size());
  points.neighbours.resize(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (int step = 0; step < 27; ++step) {
      const std::int64_t wanted = cells[c] + Lattice::offset(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      const auto at = std::lower_bound(cells.begin(), cells.end(), wanted);
      if (step != 13 && at != cells.end() && *at == wanted) points.neighbours[c].push_back(int(at - cells.begin()));
    }
  return points;
}

}  // namespace penumbra
