// moment-shadows: Fernando's steps with both regions summed in constant time by four prefiltered moments (Peters et al.
// 2016). The map is filtered once, whatever the regions' size.
#pragma once

#include "techniques/pcss/area_shadow.h"
#include "techniques/pcss/moments.h"

namespace penumbra::pcss {

class MomentShadow : public AreaShadow {
 public:
  MomentShadow(const Parameters& p, bool parallel)
      : AreaShadow(p, parallel),
        moment_bias_(p.number("moment_bias")),
        filter_scale_(float(p.number("filter_scale"))) {}
  static std::vector<Parameter> parameters();

 protected:
  void map_changed() override;
  void find_visibility(Tile& tile) override;
  std::size_t derived_bytes() const override { return table_.bytes(); }

  MomentTable table_;
  double moment_bias_;
  float filter_scale_;
};

}  // namespace penumbra::pcss
