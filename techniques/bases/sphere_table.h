// The precomputed visibility of one sphere: a bit cube for every direction of its centre and every angular radius
// (Zhao & Che 2011, section 3.3). Most entries block little of the cube, so an entry keeps only the lines of 512
// texels that it has bits in.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "scenes/cube_map.h"
#include "techniques/bases/cap.h"

namespace penumbra {

/// How r = R / distance is quantised. The paper does not say; uniform in the angle has a third of the area error.
enum class RadiusBins { uniform_angle, uniform_ratio };

/// What a look-up answers where there is no entry: the sphere's radius is 0, the point lies inside it, or the sphere
/// looks larger than the table goes and is to be rasterised.
inline constexpr int blocks_nothing = -2, blocks_everything = -1, beyond_table = -3;

/// Bins of r = R / distance, by their upper ends squared, which costs no root; uniform ones by a product instead.
/// `Squares`: 32 upper ends; anything with [].
template <class Squares>
struct BinsOf {
  int count;
  float per_ratio;  ///< bins in a ratio of 1 if uniform, else 0
  Squares upper;

  /// The number of bins if r is beyond the last.
  PENUMBRA_HD int find(float ratio2) const {
    if (per_ratio > 0.0f) {
      const float at = std::sqrt(ratio2) * per_ratio;
      return at < float(count) ? int(at) : count;
    }
    int bin = 0;
    while (bin < count && ratio2 >= upper[bin]) ++bin;
    return bin;
  }
};

/// Entry for a sphere seen from x: texel of its centre on faces of edge x edge, times the number of bins, plus the bin.
template <class Bins>
PENUMBRA_HD int sphere_table_entry(const Bins& bins, int edge, vec3 centre, float radius, vec3 x) {
  const vec3 to = centre - x;
  const float d2 = dot_in_order(to, to), r2 = radius * radius;
  if (!(r2 > 0.0f)) return blocks_nothing;
  if (!(r2 < d2)) return blocks_everything;
  const int bin = bins.find(r2 / d2);
  return bin < bins.count ? cube_texel(to, edge) * bins.count + bin : beyond_table;
}

/// The lines that a table's entry has bits in, bit by bit, and where the first of them lies in SphereTable::data(), in
/// lines; the others follow.
struct TableEntry {
  std::uint32_t first, lines;
};

class SphereTable {
 public:
  static constexpr int published_bins = 32;

  /// What a table is made for: texels, directions and radii.
  struct Shape {
    int n;           ///< texels along a face's edge, 16 or 32
    int edge, bins;  ///< 6 edge^2 directions of the centre, `bins` radii (uniform in the angle: published_bins)
    RadiusBins scheme;
    double widest;  ///< angular radius, up to which there are entries
  };
  /// As published: 6 n n directions, 32 radii up to 90 degrees.
  static Shape published(int n, RadiusBins scheme) { return {n, n, published_bins, scheme, 0.5 * pi}; }
  /// Half as many directions again along an edge, and at n = 32 64 radii up to 45 degrees: in less memory than the
  /// published table takes with all its words. Larger spheres are exact.
  static Shape fine(int n) { return {n, n * 3 / 2, 2 * n, RadiusBins::uniform_ratio, 0.25 * pi}; }

  /// Built in parallel. Throws Error if n is not 16 or 32.
  explicit SphereTable(const Shape& shape);

  const Shape& shape() const { return shape_; }
  int words() const { return 6 * shape_.n * shape_.n / 32; }
  /// Number of the entry of a sphere seen from x, or one of the answers above.
  int entry(vec3 centre, float radius, vec3 x) const {
    return sphere_table_entry(bins_, shape_.edge, centre, radius, x);
  }
  /// ORs an entry's bits into a cube of n x n x 6.
  void merge(int entry, BitCube& blocked) const;

  std::span<const TableEntry> entries() const { return entries_; }
  std::span<const std::uint32_t> data() const { return {data_.get(), data_words_}; }
  using Bins = BinsOf<std::array<float, published_bins>>;
  const Bins& bins() const { return bins_; }
  /// Cosine of the angular radius that stands for bin k.
  float cosine(int bin) const { return cosines_[bin]; }
  std::size_t bytes() const { return entries_.size() * sizeof(TableEntry) + data_words_ * sizeof(std::uint32_t); }

  struct Free {
    void operator()(std::uint32_t* p) const;
  };

 private:
  void set_radii();
  void allocate();

  Shape shape_;
  Bins bins_{};
  std::vector<float> cosines_;
  std::vector<TableEntry> entries_;
  std::size_t data_words_ = 0;
  std::unique_ptr<std::uint32_t[], Free> data_;  // on huge pages where the system gives them: look-ups are random
};

/// ORs what the spheres block, seen from x: the table's entries, and exact caps of spheres beyond it. `directions` are
/// the 6 n n texel centres.
void merge_spheres(const SphereTable& table, const SphereSet& spheres, vec3 x, const std::vector<vec3>& directions,
                   BitCube& blocked);

}  // namespace penumbra
