// chen-2016: a box filter of one width for all pixels, which knows no surfaces: the predecessor of visibility-filter,
// as Yang et al. 2019 describe it.
#pragma once

#include "techniques/visibility_filter/visibility_filter.h"

namespace penumbra::visibility_filter {

/// The mean about a pixel; `bits` know what windows hold nothing but light or nothing but shadow.
template <class Words>
PENUMBRA_HD float box_by_bits(const SurfaceRows<Words>& bits, int x, int y, int r) {
  const bool mixed = bits.bit(bits.seen, x, y) && bits.bit(bits.mixed, x, y);
  return mixed ? bits.count_all(x, y, r).mean() : float(bits.bit(bits.open, x, y));
}

class Fixed : public FilteredVisibility {
 public:
  explicit Fixed(const Parameters& p) : radius_((p.integer("width") - 1) / 2) {}

 protected:
  void filter() override;

  int radius_;
};

}  // namespace penumbra::visibility_filter
