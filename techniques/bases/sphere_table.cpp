#include "techniques/bases/sphere_table.h"

#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "scenes/error.h"

namespace penumbra {

void rasterise_spheres(const SphereSet& spheres, vec3 x, const std::vector<vec3>& directions, BitCube& blocked) {
  for (const Sphere& sphere : spheres.spheres) {
    const Cap cap = make_cap(sphere.centre, sphere.radius, x);
    for (int t = 0; t < int(directions.size()); ++t)
      if (covers(cap, directions[t])) blocked.set(t);
  }
}

void SphereTable::Free::operator()(std::uint32_t* p) const {
  std::free(p);
}

SphereTable::SphereTable(int n, RadiusBins scheme) : n_(n) {
  if (n != 16 && n != 32) throw Error("sphere table: resolution {} is not 16 or 32", n);
  for (int k = 0; k < bins; ++k) {
    const double half = 0.5 * pi;
    const double upper = scheme == RadiusBins::uniform_angle ? std::sin(half * (k + 1) / bins) : (k + 1.0) / bins;
    const double middle = scheme == RadiusBins::uniform_angle ? half * (k + 0.5) / bins : std::asin((k + 0.5) / bins);
    thresholds_[k] = k + 1 < bins ? float(upper * upper) : 2.0f;
    cosines_[k] = float(std::cos(middle));
  }
  const std::size_t huge_page = std::size_t(2) << 20;
  const std::size_t entries = std::size_t(6) * n * n * bins, size = entries * words() * sizeof(std::uint32_t);
  const std::size_t rounded = (size + huge_page - 1) / huge_page * huge_page;
  data_.reset(static_cast<std::uint32_t*>(std::aligned_alloc(huge_page, rounded)));
  if (!data_) throw std::bad_alloc();
  madvise(data_.get(), rounded, MADV_HUGEPAGE);  // a wish; ordinary pages work too
  masks_.resize(entries);
  std::vector<vec3> directions(std::size_t(6) * n * n);
  for (int t = 0; t < int(directions.size()); ++t) directions[t] = cube_texel_direction(t, n);
  tbb::parallel_for(0, int(directions.size()), [&](int t) { build_direction(t, directions); });
}

void SphereTable::build_direction(int texel, const std::vector<vec3>& directions) {
  std::uint32_t* first = data_.get() + std::size_t(texel) * bins * words();
  std::fill(first, first + std::size_t(bins) * words(), 0u);
  // A texel blocked in one bin is blocked in all larger ones: set it in its first bin, then OR upward.
  for (int t = 0; t < int(directions.size()); ++t) {
    const float cosine = dot_in_order(directions[t], directions[texel]);
    const auto bin = std::find_if(cosines_.begin(), cosines_.end(), [=](float c) { return cosine >= c; });
    if (bin != cosines_.end()) first[(bin - cosines_.begin()) * words() + t / 32] |= 1u << (t % 32);
  }
  for (int k = 0; k < bins; ++k) {
    std::uint32_t* row = first + std::size_t(k) * words();
    std::uint16_t mask = 0;
    for (int w = 0; w < words(); ++w) {
      if (k > 0) row[w] |= row[w - words()];
      if (row[w]) mask = std::uint16_t(mask | 1u << (w / words_per_line));
    }
    masks_[std::size_t(texel) * bins + k] = mask;
  }
}

std::size_t SphereTable::bytes() const {
  return masks_.size() * (words() * sizeof(std::uint32_t) + sizeof(std::uint16_t));
}

void merge_spheres(const SphereTable& table, const SphereSet& spheres, vec3 x, BitCube& blocked) {
  for (const Sphere& sphere : spheres.spheres) {
    const int entry = table.entry(sphere.centre, sphere.radius, x);
    if (entry == blocks_nothing) continue;
    if (entry == blocks_everything) return blocked.fill(true);
    const auto bits = table.bits(entry);
    for (std::size_t w = 0; w < bits.size(); ++w) blocked.words[w] |= bits[w];
  }
}

}  // namespace penumbra
