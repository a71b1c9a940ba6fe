// moment-shadows: Fernando's steps with both regions summed in constant time by four prefiltered moments (Peters et al.
// 2016). The map is filtered once, whatever the regions' size.
#include "techniques/bases/shadow_map/simd.h"
#include "techniques/moment_shadows/moments.h"

namespace penumbra {
namespace moment_shadows {
namespace {

class MomentShadow : public AreaShadow {
 public:
  explicit MomentShadow(const Parameters& p)
      : AreaShadow(p, float(p.number("region_bias"))),
        moment_bias_(p.number("moment_bias")),
        filter_scale_(float(p.number("filter_scale"))) {}

 protected:
  void map_changed() override {
    clock_.measure("moments", [&] { table_.build(map_, map_.view.farthest); });
  }
  void find_visibility(Tile& tile) override {
    const LightView& view = map_.view;
    const auto blockers = [&](int k, float width) {
      const Moments b = biased(table_.mean(texels_of(tile.x[k], tile.y[k], width)), moment_bias_);
      return blockers_of_moments(b, table_.normalised(blocking_depth(tile.depth[k], tile.rise[k], width)));
    };
    timed(blocker_part, [&] {
      for (int k = 0; k < tile.size(); ++k) {
        tile.blocker[k] = 0.0f;
        if (!(tile.depth[k] > view.near)) continue;
        const MomentBlockers found = blockers(k, view.region(view.near, tile.depth[k]));
        if (found.share > 0.0) tile.blocker[k] = std::max(view.near, table_.depth(found.mean));
      }
    });
    timed(filter_part, [&] {
      for (int k = 0; k < tile.size(); ++k) {
        const float z = tile.blocker[k], d = tile.depth[k];
        tile.visibility[k] = 1.0f;
        if (z > 0.0f && z < d) tile.visibility[k] = float(1.0 - blockers(k, view.region(z, d, filter_scale_)).share);
      }
    });
  }
  std::size_t derived_bytes() const override { return table_.bytes(); }

  MomentTable table_;
  double moment_bias_;
  float filter_scale_;
};

class MomentShadowSimd final : public Simd<MomentShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    timed(blocker_part, [&] { find_blockers(map_.view, table_, moment_bias_, tile); });
    timed(filter_part, [&] { filter(map_.view, table_, moment_bias_, filter_scale_, tile); });
  }
};

}  // namespace
}  // namespace moment_shadows

void register_moment_shadows(Registry& registry) {
  Entry entry = shadow_map::AreaShadow::entry(
      {number_parameter("moment_bias", 1e-7, 1e-12, 0.1, "", "share of evenly spread depths in the moments"),
       shadow_map::region_bias_parameter(0.0), shadow_map::filter_scale_parameter()});
  entry.name = "moment-shadows";
  entry.summary = "both regions in constant time by four moments in a summed-area table";
  entry.citation = "Peters & Klein 2015; Peters et al. 2016";
  add_pair<moment_shadows::MomentShadow, moment_shadows::MomentShadowSimd>(registry, std::move(entry));
}

}  // namespace penumbra
