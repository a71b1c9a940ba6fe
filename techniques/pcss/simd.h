// The simd backend of the pipeline: the same steps with the kernels of kernel.h.
#pragma once

#include "techniques/bases/for_ranges.h"
#include "techniques/bases/shadow_map/simd.h"
#include "techniques/pcss/kernel.h"
#include "techniques/pcss/pcss.h"

namespace penumbra::pcss {

class SoftShadowSimd : public Simd<SoftShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_regions(Tile& tile) const override {
    if (options_.snapping.size == Snapping::Size::overlap)
      return SoftShadow::find_regions(tile);  // four look-ups of sizes of their own
    simd::search_regions(map_.view, levels_, options_, tile);
  }
  void make_filter_regions(Tile& tile) const override { simd::filter_regions(map_.view, levels_, options_, tile); }
  Blockers blockers_in(const Tile& tile, int k, Sum how, bool depths) const override {
    const float d = blocking_depth(tile.depth[k], tile.rise[k], tile.width[k]);
    if (how == Sum::texels) return simd::blockers_of_texels(map_, texels_of(tile.x[k], tile.y[k], tile.width[k]), d);
    return simd::blockers_of_square(map_, levels_, samples_, tile.square[k], options_.depth, d, how, depths);
  }
  void blur_image(const MaskedImage& image, MaskedImage& between, std::vector<float>& out) const override {
    for_ranges(image.height, 8, [&](int begin, int end) { simd::blur_rows(image, kernel_, begin, end, between); });
    for_ranges(image.height, 8,
               [&](int begin, int end) { simd::blur_columns(between, kernel_, begin, end, out.data()); });
  }
};

/// Adds a member on both backends.
template <SoftOptions (*options)(const Parameters&)>
void add_member(Registry& registry, Entry entry) {
  add_pair<Member<SoftShadow, options>, Member<SoftShadowSimd, options>>(registry, std::move(entry));
}

}  // namespace penumbra::pcss
