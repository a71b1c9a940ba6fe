// Percentage-closer soft shadows in three forms of one pipeline, each with a file of its own:
//   pcss       every texel of both regions                                          Fernando 2005
//   hqepcss    search region refined by a multi-scale map, blocker depth by a quadtree; every texel of the filter
//              region                                                               Shen et al. 2014
//   fast-pcss  reduced multi-scale map, both regions by a quadtree with samples, results shared by neighbours, blur
//                                                                                   Zhu et al. 2019
// Per receiver of depth d at map coordinates (x, y), with W the width of light_view.h:
//   1 search region  W(n), n the occluder's least depth; refined: W(least depth in the region), until it stays
//   2 blocker depth  z = mean depth of the region's texels nearer than d
//   3 filter region  c W(z)
//   4 shadow         share of its texels that are nearer than d
// For receivers on the mesh, nearer than blocking_depth() in both, each time by the region's own width.
#pragma once

#include "techniques/bases/shadow_map/area_shadow.h"
#include "techniques/pcss/blur.h"
#include "techniques/pcss/reuse.h"
#include "techniques/pcss/traversal.h"

namespace penumbra::pcss {

/// How the texels of a region are summed.
enum class Sum { texels, nearest, sampled };

struct SoftOptions {
  bool multi_scale = false;  ///< a multi-scale map is there
  LevelLayout layout = LevelLayout::reduced;
  bool build_all = false;  ///< all levels, not only those that the frame's regions need
  bool refine = false;
  Sum search = Sum::texels, filter = Sum::texels;
  int depth = 3;  ///< levels of the quadtree below a region
  Snapping snapping;
  Reuse search_reuse, filter_reuse;
  float filter_scale = 1.0f;  ///< c
  int blur = 0;               ///< radius, receivers
};

constexpr int most_refinements = 4;

/// A region as the steps want it; lit: nothing in it can block.
struct Region {
  bool lit = true;
  float width = 0.0f;  ///< texels
  Square square;       ///< that stands for it, with a multi-scale map
};

/// Least depth in a region: of its square or, with Size::overlap, of squares of half the size or more that cover it
/// exactly.
template <class Levels>
PENUMBRA_HD float least_depth(const Levels& levels, const SoftOptions& options, const Square& square, float x, float y,
                              float width) {
  if (options.snapping.size != Snapping::Size::overlap) return levels.low(square);
  int left, right, top, bottom;
  snapped_range(x, width, levels.edge(), options.snapping.inclusive, left, right);
  snapped_range(y, width, levels.edge(), options.snapping.inclusive, top, bottom);
  const int shorter = right - left < bottom - top ? right - left : bottom - top;
  const int fitting = int(std::bit_width(unsigned(shorter + 1))) - 1;
  const int level = fitting < levels.largest() ? fitting : levels.largest(), edge = 1 << level;
  float low = levels.low({left, top, level});
  for (int t = top;;) {
    for (int l = left;;) {
      const float depth = levels.low({l, t, level});
      low = depth < low ? depth : low;
      if (l + edge > right) break;
      l = l + edge < right + 1 - edge ? l + edge : right + 1 - edge;
    }
    if (t + edge > bottom) break;
    t = t + edge < bottom + 1 - edge ? t + edge : bottom + 1 - edge;
  }
  return low;
}

/// Step 1.
template <class Levels>
PENUMBRA_HD Region search_region(const LightView& view, const Levels& levels, const SoftOptions& options,
                                 const Projected& at) {
  const auto& [x, y, d, rise] = at;
  const int n = view.resolution;
  if (!(d > view.near)) return {};
  float width = view.region(view.near, d);
  if (misses_map(x, y, width, n)) return {};
  if (options.refine) {
    for (int i = 0; i < most_refinements; ++i) {
      const Square square = snap(x, y, width, n, levels.largest(), options.snapping);
      if (square.level < 0) return {};
      const float low = least_depth(levels, options, square, x, y, width);
      if (!(low < blocking_depth(d, rise, width))) return {};
      const float before = width, refined = view.region(low, d);
      width = refined < before ? refined : before;
      if (before - width < 1.0f) break;
    }
  }
  if (!options.multi_scale) return {false, width, {}};
  const Square square = snap(x, y, width, n, levels.largest(), options.snapping);
  return {square.level < 0, width, square};
}

/// Step 3, for a mean blocker depth; 0: there is none. A shared blocker may lie behind the receiver, and then is none.
PENUMBRA_HD inline Region filter_region(const LightView& view, int largest, const SoftOptions& options,
                                        const Projected& at, float blocker) {
  const auto& [x, y, d, rise] = at;
  if (!(blocker > 0.0f) || !(blocker < d)) return {};
  const float width = view.region(blocker, d, options.filter_scale);
  if (!options.multi_scale) return {false, width, {}};
  const Square square = snap(x, y, width, view.resolution, largest, options.snapping);
  return {square.level < 0, width, square};
}

/// The largest square that stands for any region of a map, for widths up to `width` texels.
int needed_level(float width, int edge);

class SoftShadow : public AreaShadow {
 public:
  SoftShadow(const Parameters& parameters, const SoftOptions& options);

 protected:
  void map_changed() override;
  int largest_needed() const;  ///< level
  void find_visibility(Tile& tile) final;
  void finish(std::vector<float>& visibility) override;
  int tile_multiple() const override;
  std::size_t derived_bytes() const override { return options_.multi_scale ? levels_.bytes() : 0; }

  // The steps, for the receivers of a tile. A representative of -1 means lit.
  virtual void find_regions(Tile& tile) const;         ///< depth, x, y -> width, square, representative
  virtual void make_filter_regions(Tile& tile) const;  ///< blocker -> width, square, representative
  virtual void blur_image(const MaskedImage& image, MaskedImage& between, std::vector<float>& out) const;
  /// Of the region of receiver k. Where `depths` is false only their number is asked for.
  virtual Blockers blockers_in(const Tile& tile, int k, Sum how, bool depths) const;

  const SoftOptions options_;
  MultiScaleMap levels_;
  LeafSamples samples_;
  std::vector<float> kernel_;  ///< of the blur

 private:
  void find_blockers(Tile& tile) const;  ///< representatives' regions -> blocker
  void filter(Tile& tile) const;         ///< representatives' regions -> visibility

  MaskedImage image_, between_;
};

}  // namespace penumbra::pcss
