// shadow-map: the baseline. Share of the n x n texels about the receiver that are not nearer to the light than it
// (percentage-closer filtering, Reeves et al. 1987); n = 1 is a hard shadow (Williams 1978).
#pragma once

#include "techniques/pcss/area_shadow.h"

namespace penumbra::pcss {

/// Of texels; those outside the map are empty.
inline float percentage_closer(const ShadowMap& map, float x, float y, int kernel, float d) {
  const int edge = map.resolution();
  const int left = floor_int(x) - (kernel - 1) / 2, top = floor_int(y) - (kernel - 1) / 2;
  int open = 0;
  for (int v = top; v < top + kernel; ++v)
    for (int u = left; u < left + kernel; ++u) open += u < 0 || v < 0 || u >= edge || v >= edge || !(map.at(u, v) < d);
  return float(open) / float(kernel * kernel);
}

class HardShadow : public AreaShadow {
 public:
  HardShadow(const Parameters& p, bool parallel) : AreaShadow(p, parallel), kernel_(p.integer("kernel")) {}
  static std::vector<Parameter> parameters();

 protected:
  void find_visibility(Tile& tile) override;
  int kernel_;
};

}  // namespace penumbra::pcss
