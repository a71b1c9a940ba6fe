#include "techniques/bases/sphere_table.h"

#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "scenes/error.h"

namespace penumbra {
namespace {

void rasterise_sphere(const Sphere& sphere, vec3 x, const std::vector<vec3>& directions, BitCube& blocked) {
  const Cap cap = make_cap(sphere.centre, sphere.radius, x);
  for (int t = 0; t < int(directions.size()); ++t)
    if (covers(cap, directions[t])) blocked.set(t);
}

/// The words of one direction's entries, bin after bin.
std::vector<std::uint32_t> bits_of_direction(vec3 axis, const std::vector<vec3>& directions,
                                             const std::vector<float>& cosines) {
  // A texel blocked in one bin is blocked in all larger ones: set it in its first bin, then OR upward.
  const std::size_t words = directions.size() / 32;
  std::vector<std::uint32_t> bits(cosines.size() * words, 0u);
  for (std::size_t t = 0; t < directions.size(); ++t) {
    const float cosine = dot_in_order(directions[t], axis);
    const auto bin = std::lower_bound(cosines.begin(), cosines.end(), cosine, std::greater<>());
    if (bin != cosines.end()) bits[std::size_t(bin - cosines.begin()) * words + t / 32] |= 1u << (t % 32);
  }
  for (std::size_t w = words; w < bits.size(); ++w) bits[w] |= bits[w - words];
  return bits;
}

}  // namespace

void rasterise_spheres(const SphereSet& spheres, vec3 x, const std::vector<vec3>& directions, BitCube& blocked) {
  for (const Sphere& sphere : spheres.spheres) rasterise_sphere(sphere, x, directions, blocked);
}

void SphereTable::Free::operator()(std::uint32_t* p) const {
  std::free(p);
}

void SphereTable::set_radii() {
  const double widest = std::sin(shape_.widest);
  const bool uniform = shape_.scheme == RadiusBins::uniform_ratio;
  bins_ = {shape_.bins, uniform ? float(shape_.bins / widest) : 0.0f, {}};
  for (int k = 0; k < shape_.bins; ++k) {
    const auto ratio = [&](double share) { return uniform ? widest * share : std::sin(shape_.widest * share); };
    const double middle = ratio((k + 0.5) / shape_.bins), upper = ratio((k + 1.0) / shape_.bins);
    cosines_.push_back(float(std::sqrt(1.0 - middle * middle)));
    if (!uniform) bins_.upper[k] = k + 1 < shape_.bins ? float(upper * upper) : 2.0f;
  }
}

void SphereTable::allocate() {
  const std::size_t huge_page = std::size_t(2) << 20, size = std::max<std::size_t>(1, data_words_ * 4);
  const std::size_t rounded = (size + huge_page - 1) / huge_page * huge_page;
  data_.reset(static_cast<std::uint32_t*>(std::aligned_alloc(huge_page, rounded)));
  if (!data_) throw std::bad_alloc();
  madvise(data_.get(), rounded, MADV_HUGEPAGE);  // a wish; ordinary pages work too
}

SphereTable::SphereTable(const Shape& shape) : shape_(shape) {
  if (shape.n != 16 && shape.n != 32) throw Error("sphere table: resolution {} is not 16 or 32", shape.n);
  set_radii();
  std::vector<vec3> texels(std::size_t(6) * shape.n * shape.n);
  for (int t = 0; t < int(texels.size()); ++t) texels[t] = cube_texel_direction(t, shape.n);
  const int directions = 6 * shape.edge * shape.edge, lines = words() / words_per_line;
  entries_.resize(std::size_t(directions) * std::size_t(shape.bins));
  std::vector<std::vector<std::uint32_t>> kept{std::size_t(directions)};
  tbb::parallel_for(0, directions, [&](int direction) {
    const auto bits = bits_of_direction(cube_texel_direction(direction, shape.edge), texels, cosines_);
    for (int bin = 0; bin < shape.bins; ++bin) {
      TableEntry& entry = entries_[std::size_t(direction) * std::size_t(shape.bins) + std::size_t(bin)];
      entry = {std::uint32_t(kept[direction].size()) / words_per_line, 0};
      for (int line = 0; line < lines; ++line) {
        const auto begin = bits.begin() + (bin * lines + line) * words_per_line, end = begin + words_per_line;
        if (std::all_of(begin, end, [](std::uint32_t w) { return w == 0; })) continue;
        entry.lines |= 1u << line;
        kept[direction].insert(kept[direction].end(), begin, end);
      }
    }
  });
  for (const auto& words_of : kept) data_words_ += words_of.size();
  allocate();
  std::size_t at = 0;
  for (int direction = 0; direction < directions; ++direction) {
    for (int bin = 0; bin < shape.bins; ++bin)
      entries_[std::size_t(direction) * std::size_t(shape.bins) + std::size_t(bin)].first +=
          std::uint32_t(at / words_per_line);
    std::copy(kept[direction].begin(), kept[direction].end(), data_.get() + at);
    at += kept[direction].size();
    std::vector<std::uint32_t>().swap(kept[direction]);
  }
}

void SphereTable::merge(int entry, BitCube& blocked) const {
  const auto [first, lines] = entries_[entry];
  const std::uint32_t* from = data_.get() + std::size_t(first) * words_per_line;
  for (std::uint32_t left = lines; left; left &= left - 1, from += words_per_line)
    for (int w = 0; w < words_per_line; ++w) blocked.words[std::countr_zero(left) * words_per_line + w] |= from[w];
}

void merge_spheres(const SphereTable& table, const SphereSet& spheres, vec3 x, const std::vector<vec3>& directions,
                   BitCube& blocked) {
  for (const Sphere& sphere : spheres.spheres) {
    const int entry = table.entry(sphere.centre, sphere.radius, x);
    if (entry == blocks_everything) return blocked.fill(true);
    if (entry == beyond_table) rasterise_sphere(sphere, x, directions, blocked);
    else if (entry != blocks_nothing) table.merge(entry, blocked);
  }
}

}  // namespace penumbra
