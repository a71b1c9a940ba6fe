// The precomputed visibility of one sphere: 6 n n directions x 32 angular radii, one bit cube each (144 MiB at n = 32;
// Zhao & Che 2011, section 3.3).
#pragma once

#include <array>
#include <memory>
#include <span>

#include "scenes/cube_map.h"
#include "techniques/bases/cap.h"

namespace penumbra {

/// How r = R / distance is quantised. The paper does not say; uniform in the angle has a third of the area error.
enum class RadiusBins { uniform_angle, uniform_ratio };

/// What a look-up answers where no entry is needed: the sphere's radius is 0, or the point lies inside it.
inline constexpr int blocks_nothing = -2, blocks_everything = -1;

/// Entry for a sphere seen from x: texel of its centre times the number of bins, plus the bin of r = R / distance.
/// `thresholds`: see SphereTable::thresholds().
template <class Thresholds>
PENUMBRA_HD int sphere_table_entry(const Thresholds& thresholds, int n, vec3 centre, float radius, vec3 x) {
  const vec3 to = centre - x;
  const float d2 = dot_in_order(to, to), r2 = radius * radius;
  if (!(r2 > 0.0f)) return blocks_nothing;
  if (!(r2 < d2)) return blocks_everything;
  const float ratio2 = r2 / d2;
  int bin = 0;
  while (ratio2 >= thresholds[bin]) ++bin;
  return cube_texel(to, n) * 32 + bin;
}

class SphereTable {
 public:
  static constexpr int bins = 32;

  /// Built in parallel. n is 16 or 32.
  SphereTable(int n, RadiusBins scheme);

  int n() const { return n_; }
  int words() const { return 6 * n_ * n_ / 32; }
  /// Entry of a sphere seen from x, or blocks_nothing, or blocks_everything.
  int entry(vec3 centre, float radius, vec3 x) const { return sphere_table_entry(thresholds_, n_, centre, radius, x); }
  std::span<const std::uint32_t> bits(int entry) const {
    return {data_.get() + std::size_t(entry) * words(), std::size_t(words())};
  }
  /// Bit k is set where line k of the entry has a blocked texel.
  std::uint16_t line_mask(int entry) const { return masks_[entry]; }

  const std::uint32_t* data() const { return data_.get(); }
  const std::uint16_t* masks() const { return masks_.data(); }
  /// Bin k holds thresholds()[k - 1] <= r^2 < thresholds()[k] (squares cost no root); 31 thresholds and one above every
  /// r.
  const std::array<float, bins>& thresholds() const { return thresholds_; }
  /// Cosine of the angular radius that stands for bin k.
  float cosine(int bin) const { return cosines_[bin]; }
  std::size_t bytes() const;

  struct Free {
    void operator()(std::uint32_t* p) const;
  };

 private:
  void build_direction(int texel, const std::vector<vec3>& directions);

  int n_;
  std::array<float, bins> thresholds_, cosines_;
  std::unique_ptr<std::uint32_t[], Free> data_;  // on huge pages where the system gives them: look-ups are random
  std::vector<std::uint16_t> masks_;
};

/// ORs the table's entries of all spheres seen from x: the paper's merge, 192 words a sphere.
void merge_spheres(const SphereTable& table, const SphereSet& spheres, vec3 x, BitCube& blocked);

}  // namespace penumbra
