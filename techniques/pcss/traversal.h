// Blockers in a region: how many texels are nearer to the light than the receiver, and how near.
//
//   texels:   every texel of the region (Fernando 2005).
//   quadtree: squares of the multi-scale map from the top down. All texels nearer: taken whole. None: skipped. Some:
//             the four quarters, until `leaf_level`. There (Shen et al. 2014) the whole leaf counts at its least depth,
//             or (Zhu et al. 2019, section 3) 1, 4 or 16 samples stand for it.
// The quadtree is linear: squares of any level and offset are stored, so a node is three numbers.
#pragma once

#include "techniques/bases/shadow_map/samples.h"
#include "techniques/pcss/multi_scale_map.h"

namespace penumbra::pcss {

/// Texels that block, and the sum of their depths.
struct Blockers {
  float count = 0.0f, depth_sum = 0.0f;
  PENUMBRA_HD float mean() const { return count > 0.0f ? depth_sum / count : 0.0f; }  ///< 0: there is none
  PENUMBRA_HD void add(float texels, float depth) { count += texels, depth_sum += texels * depth; }
};

/// Texels outside the map are empty. `Row` sums the depths of a row: a region may have a million texels.
template <class Row = double, class Map>
PENUMBRA_HD Blockers blockers_of_texels(const Map& map, const Texels& t, float d) {
  const int n = map.resolution();
  const int left = t.left > 0 ? t.left : 0, right = t.right < n ? t.right : n;
  const int top = t.top > 0 ? t.top : 0, bottom = t.bottom < n ? t.bottom : n;
  int count = 0;
  double depth_sum = 0.0;
  for (int y = top; y < bottom; ++y) {
    Row row = 0;
    for (int x = left; x < right; ++x)
      if (const float z = map.at(x, y); z < d) ++count, row += Row(z);
    depth_sum += double(row);
  }
  return {float(count), float(depth_sum)};
}

/// Leaf rule of Shen et al. 2014.
PENUMBRA_HD inline Blockers nearest_leaf(const Square& leaf, const DepthRange& range) {
  const auto texels = float(leaf.edge() * leaf.edge());
  return {texels, texels * range.low};
}

/// Where the samples of a leaf lie on a shadow map, from the texel of its corner: SampleImage scaled once to every
/// size.
class LeafSamples {
 public:
  LeafSamples() = default;
  LeafSamples(const SampleImage& image, const ShadowMap& map);
  /// 16 offsets of a leaf of 2^level texels; SampleImage::count() of them count.
  PENUMBRA_HD static std::size_t first(int level, int variant) {
    return std::size_t(level * SampleImage::variants + variant) * 16;
  }
  const std::int32_t* of(int level, int variant) const { return &offset_[first(level, variant)]; }
  int stride() const { return stride_; }  ///< of the maps that they are for
  const std::vector<std::int32_t>& offsets() const { return offset_; }

 private:
  int stride_ = 0;
  std::vector<std::int32_t> offset_;
};

/// Leaf rule of Zhu et al. 2019, equations 5 and 6: the share of samples that block, times the leaf's texels.
/// `depth` are the map's texels and `offsets` those of LeafSamples.
template <class Map, class Depths, class Offsets>
PENUMBRA_HD Blockers sampled_leaf(const Map& map, const Depths& depth, const Offsets& offsets, const Square& leaf,
                                  float d) {
  const int edge = leaf.edge(), count = SampleImage::count(edge);
  // (x + y) mod 8 of the leaf's centre.
  const std::size_t first = LeafSamples::first(leaf.level, (leaf.left + leaf.top + edge) % SampleImage::variants);
  const std::size_t corner = map.index(leaf.left, leaf.top);
  Blockers found;
  for (int k = 0; k < count; ++k)
    if (const float z = depth[corner + std::size_t(offsets[first + std::size_t(k)])]; z < d) found.add(1.0f, z);
  const float scale = float(edge * edge) / float(count);
  return {scale * found.count, scale * found.depth_sum};
}
inline Blockers sampled_leaf(const ShadowMap& map, const LeafSamples& samples, const Square& leaf, float d) {
  return sampled_leaf(map, map.depth, samples.offsets(), leaf, d);
}

/// `leaf(square, range)` gives the blockers of an undecided leaf. Without `depths` only texels are counted.
template <bool depths, class Leaf>
void traverse(const MultiScaleMap& map, const Square& node, int leaf_level, float d, const Leaf& leaf,
              Blockers& found) {
  const DepthRange range = map.range(node);
  if (range.high < d) {
    found.add(float(node.edge() * node.edge()), depths ? map.mean(node) : 0.0f);
  } else if (range.low < d) {
    if (node.level <= leaf_level) {
      const Blockers inside = leaf(node, range);
      found.count += inside.count, found.depth_sum += inside.depth_sum;
      return;
    }
    const int half = node.edge() / 2;
    for (const int y : {0, half})
      for (const int x : {0, half})
        traverse<depths>(map, {node.left + x, node.top + y, node.level - 1}, leaf_level, d, leaf, found);
  }
}

}  // namespace penumbra::pcss
