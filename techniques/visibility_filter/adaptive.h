// visibility-filter: the width of every pixel's filter follows from how large lamp and nearest caster are seen, and a
// mask keeps it on its surface (Yang et al. 2019). A lit pixel has no caster of its own: it takes the one of the
// nearest shadowed pixel on its surface within half the widest filter.
#pragma once

#include <algorithm>

#include "techniques/visibility_filter/filter_width.h"
#include "techniques/visibility_filter/surface_rows.h"
#include "techniques/visibility_filter/visibility_filter.h"

namespace penumbra::visibility_filter {

/// What all pixels are filtered by.
struct Filtering {
  WidthModel model;
  float epsilon = 0.0f;  ///< m
  bool borrows = true;   ///< lit pixels take a caster

  PENUMBRA_HD int search_radius() const { return model.most / 2; }
};

/// A pixel that was filtered (radius > 0) or keeps its own visibility.
struct Filtered {
  int radius = 0;
  float visibility = 1.0f;
};

/// By the ring loop. `same` is scratch.
Filtered filter_by_rings(const PixelMap& map, int x, int y, float to_eye, const Filtering& how,
                         std::vector<std::uint8_t>& same);

/// By bits, which know what windows hold nothing but light or nothing but shadow: first the radius, 0 of a pixel that
/// keeps its own visibility, then the visibility. `depth` and `caster` are the map's.
template <class Words, class Floats>
PENUMBRA_HD int radius_by_bits(const SurfaceRows<Words>& bits, const Floats& depth, const Floats& caster, int x, int y,
                               float to_eye, const Filtering& how) {
  const bool open = bits.bit(bits.open, x, y);
  if (!bits.bit(bits.seen, x, y) || (open && !(how.borrows && bits.bit(bits.mixed, x, y)))) return 0;
  const std::size_t i = bits.pixel(x, y);
  const float nearest = open ? bits.borrowed_caster(caster, x, y, how.search_radius()) : caster[i];
  return filter_radius(how.model, depth[i], nearest, to_eye);
}
template <class Words>
PENUMBRA_HD float visibility_by_bits(const SurfaceRows<Words>& bits, int x, int y, int radius) {
  if (radius > 0 && bits.bit(bits.mixed, x, y)) return bits.count(x, y, radius).mean();
  return float(bits.bit(bits.open, x, y));
}

class Adaptive : public FilteredVisibility {
 public:
  explicit Adaptive(const Parameters& p);

  std::map<std::string, std::size_t> counters() const override {
    return {{"filtered", widths_.filtered},
            {"least_width", std::size_t(widths_.least)},
            {"mean_width", widths_.mean()},
            {"most_width", std::size_t(widths_.most)}};
  }

 protected:
  /// D1, and at rest what the published units are in metres.
  void receivers_moved(bool at_rest) override;
  void filter() override;

  float to_eye(std::size_t i) const { return receivers_->view_depth.empty() ? 1.0f : receivers_->view_depth[i]; }

  /// Of the pixels that were filtered.
  struct Widths {
    std::size_t filtered = 0, sum = 0;
    int least = 0, most = 0;
    void note(int r) {
      if (r > 0) add({1, std::size_t(2 * r + 1), 2 * r + 1, 2 * r + 1});
    }
    void add(const Widths& other) {
      if (other.filtered == 0) return;
      least = filtered == 0 ? other.least : std::min(least, other.least);
      most = std::max(most, other.most);
      filtered += other.filtered, sum += other.sum;
    }
    std::size_t mean() const { return filtered == 0 ? 0 : (sum + filtered / 2) / filtered; }  ///< to whole pixels
  };

  Filtering filtering_;
  Widths widths_;

 private:
  float light_share_, depth_units_, epsilon_units_;
  bool lamp_width_, follows_eye_;
};

}  // namespace penumbra::visibility_filter
