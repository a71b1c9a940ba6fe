// The kernels of soft_shadow.cu: what techniques/pcss does to a tile of receivers, a thread a receiver.
#pragma once

#include "cuda/lamp.h"
#include "cuda/shadow_map.h"
#include "techniques/pcss/soft_shadow.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

using pcss::Blockers;
using pcss::Region;
using pcss::SoftOptions;
using pcss::Sum;
using shadow_map::LightView;
using shadow_map::Square;

template <class Floats>
using Levels = pcss::MultiScaleLevels<Floats>;

/// What is known of every receiver, as shadow_map::Tile.
struct ReceiverState {
  Span<shadow_map::Projected> at;
  Span<float> width;
  Span<Square> square;
  Span<int> link;  ///< receiver whose result this one takes, itself, or -1: lit
  Span<float> blocker, visibility;
  std::size_t count;
};

/// The shadow map and samples in it.
struct SampledMap : MapSpans {
  Span<const std::int32_t> samples;
};

// NOLINTBEGIN(misc-definitions-in-headers): this header is a part of soft_shadow.cu, which alone reads it

// --- the multi-scale map ---------------------------------------------------------------------------------------------

__global__ void __launch_bounds__(threads) copy_map(MapSpans map, Levels<Span<float>> levels) {
  const unsigned k = global_thread();
  const int x = int(k) % map.edge, y = int(k) / map.edge;
  if (y < map.edge) levels.set_texel(x, y, map.at(x, y));
}

__global__ void __launch_bounds__(threads) build_level(Levels<Span<float>> levels, int level) {
  const unsigned k = global_thread();
  const int stride = levels.stride(level), x = int(k) % stride, y = int(k) / stride;
  if (y >= stride) return;
  levels.merge(x, y, level);
  tally(10);
}

// --- regions ---------------------------------------------------------------------------------------------------------

__device__ inline void take_region(const ReceiverState& r, std::size_t i, const Region& region) {
  r.width[i] = region.width, r.square[i] = region.square;
  r.link[i] = region.lit ? -1 : int(i);
}

__global__ void __launch_bounds__(threads)
    search_regions(LightView view, Levels<Span<const float>> levels, SoftOptions options, shadow_map::Bias bias,
                   ReceiverSpans receivers, ReceiverState r) {
  const std::size_t i = global_thread();
  if (i >= r.count) return;
  const shadow_map::Projected at =
      shadow_map::project(view, bias, receivers.position[i], receivers.normal[i], receivers.touches[i] != 0);
  r.at[i] = at;
  take_region(r, i, pcss::search_region(view, levels, options, at));
  tally(options.refine ? 120 : 60);
}

/// The receiver whose result i takes: follows the links to one that has its own; -1: lit.
__device__ inline int representative(const Span<const int>& links, std::size_t i) {
  int k = int(i), next = links[i];
  while (next != k && next >= 0) k = next, next = links[std::size_t(k)];
  return next;
}

/// The mean blocker depth of who stands for the receiver, and the filter region that it gives.
__global__ void __launch_bounds__(threads)
    make_filter_regions_of(LightView view, int largest, SoftOptions options, Span<const int> links, ReceiverState r) {
  const std::size_t i = global_thread();
  if (i >= r.count) return;
  const int from = representative(links, i);
  const Region region =
      from < 0 ? Region() : pcss::filter_region(view, largest, options, r.at[i], r.blocker[std::size_t(from)]);
  take_region(r, i, region);
  tally(40);
}

// --- results shared by neighbours ------------------------------------------------------------------------------------

/// Links a receiver to its left neighbour if they are alike, else to its upper one, within areas (pcss/reuse.h).
/// `links` becomes the new r.link.
__global__ void __launch_bounds__(threads)
    link_neighbours(pcss::Reuse how, int width, ReceiverState r, Span<int> links) {
  const std::size_t i = global_thread();
  if (i >= r.count) return;
  const int x = int(i) % width, y = int(i) / width, own = int(i);
  links[i] = r.link[i];
  const bool left_inside = x % how.area != 0, up_inside = y % how.area != 0;
  if (r.link[i] < 0 || (how.literal && !(left_inside && up_inside))) return;
  const auto key = [&](int k) {
    return pcss::region_key(r.at[std::size_t(k)], r.width[std::size_t(k)], r.square[std::size_t(k)]);
  };
  const auto shares = [&](bool inside, int other) {
    tally(20);
    return inside && r.link[std::size_t(other)] >= 0 && pcss::alike(key(own), key(other), how);
  };
  if (shares(left_inside, own - 1)) links[i] = own - 1;
  else if (shares(up_inside, own - width)) links[i] = own - width;
}

/// Lists the receivers that find a result of their own, in no order. count[0] must be 0 before.
__global__ void __launch_bounds__(threads) gather(Span<const int> links, Span<int> list, Span<unsigned> count) {
  const std::size_t i = global_thread();
  const bool own = i < links.size && links[i] == int(i);
  const unsigned ballot = __ballot_sync(all_lanes, own), lane = threadIdx.x % warp_lanes;
  unsigned first = 0;
  if (lane == 0 && ballot != 0) first = atomic_add(count, 0, unsigned(__popc(ballot)));
  first = __shfl_sync(all_lanes, first, 0);
  if (own) list[first + unsigned(__popc(ballot & ((1u << lane) - 1u)))] = int(i);
}

__global__ void clear_count(Span<unsigned> count) {
  if (threadIdx.x == 0) count[0] = 0;
}

// --- blockers --------------------------------------------------------------------------------------------------------

/// Every other bit of an index of the quadtree: the column of a node, or, shifted by one, its row.
__device__ inline int every_other_bit(unsigned bits) {
  bits &= 0x55555555u;
  bits = (bits | bits >> 1) & 0x33333333u;
  bits = (bits | bits >> 2) & 0x0f0f0f0fu;
  bits = (bits | bits >> 4) & 0x00ff00ffu;
  return int((bits | bits >> 8) & 0xffffu);
}

/// pcss::traverse without a stack: nodes of a level are numbered in the order of their visit, two bits a level.
template <bool depths, class Leaf>
__device__ Blockers traverse(const Levels<Span<const float>>& levels, const Square& root, int leaf_level, float d,
                             const Leaf& leaf) {
  Blockers found;
  unsigned number = 0;
  for (int level = root.level;;) {
    const Square node{root.left + (every_other_bit(number) << level),
                      root.top + (every_other_bit(number >> 1) << level), level};
    const pcss::DepthRange range = levels.range(node);
    tally(4);
    if (range.high < d) {
      found.add(float(node.edge() * node.edge()), depths ? levels.mean(node) : 0.0f);
    } else if (range.low < d && level > leaf_level) {
      number *= 4, --level;
      continue;
    } else if (range.low < d) {
      const Blockers inside = leaf(node, range);
      found.count += inside.count, found.depth_sum += inside.depth_sum;
    }
    while (level < root.level && number % 4 == 3) number /= 4, ++level;
    if (level == root.level) return found;
    ++number;
  }
}

template <Sum how, bool depths>
__device__ Blockers blockers_in(const SampledMap& map, const Levels<Span<const float>>& levels, int tree_depth,
                                const shadow_map::Projected& at, float width, const Square& square) {
  const float d = shadow_map::blocking_depth(at.depth, at.rise, width);
  if constexpr (how == Sum::texels) {
    return pcss::blockers_of_texels<float>(map, shadow_map::texels_of(at.x, at.y, width), d);
  } else {
    const int leaf_level = square.level > tree_depth ? square.level - tree_depth : 0;
    const auto rule = [&](const Square& leaf, const pcss::DepthRange& range) {
      if constexpr (how == Sum::nearest) {
        return pcss::nearest_leaf(leaf, range);
      } else {
        tally(float(3 * shadow_map::SampleImage::count(leaf.edge())));
        return pcss::sampled_leaf(map, map.depth, map.samples, leaf, d);
      }
    };
    return traverse<depths>(levels, square, leaf_level, d, rule);
  }
}

/// Step 2: mean depths of blockers, for the listed receivers.
template <Sum how>
__global__ void __launch_bounds__(threads)
    sum_blockers(SampledMap map, Levels<Span<const float>> levels, int tree_depth, Span<const int> list,
                 Span<const unsigned> count, ReceiverState r) {
  const unsigned k = global_thread();
  if (k >= count[0]) return;
  const auto i = std::size_t(list[k]);
  r.blocker[i] = blockers_in<how, true>(map, levels, tree_depth, r.at[i], r.width[i], r.square[i]).mean();
}

/// Step 4: shares of open texels, for the listed receivers.
template <Sum how>
__global__ void __launch_bounds__(threads)
    sum_filter(SampledMap map, Levels<Span<const float>> levels, int tree_depth, Span<const int> list,
               Span<const unsigned> count, ReceiverState r) {
  const unsigned k = global_thread();
  if (k >= count[0]) return;
  const auto i = std::size_t(list[k]);
  const shadow_map::Projected at = r.at[i];
  const Square square = r.square[i];
  const float blocked = blockers_in<how, false>(map, levels, tree_depth, at, r.width[i], square).count;
  const float all = how == Sum::texels ? float(shadow_map::texels_of(at.x, at.y, r.width[i]).count())
                                       : float(square.edge() * square.edge());
  r.visibility[i] = 1.0f - blocked / all;
}

// --- the image -------------------------------------------------------------------------------------------------------

struct MaskedSpans {
  Span<float> value, weight;
};

/// Visibility of every receiver, and whether it counts.
__global__ void __launch_bounds__(threads)
    spread_visibility(ReceiverSpans receivers, ReceiverState r, MaskedSpans image) {
  const std::size_t i = global_thread();
  if (i >= r.count) return;
  const int from = representative(r.link, i);
  image.value[i] = from < 0 ? 1.0f : r.visibility[std::size_t(from)];
  image.weight[i] = receivers.valid(i) ? 1.0f : 0.0f;
}

__global__ void __launch_bounds__(threads)
    blur_image_rows(MaskedSpans in, Span<const float> kernel, int width, MaskedSpans out) {
  const std::size_t i = global_thread();
  if (i >= in.value.size) return;
  const auto x = int(i % std::size_t(width));
  pcss::blur_at(in.value, in.weight, kernel, int(kernel.size) - 1, false, i - std::size_t(x), 1, x, width, out.value[i],
                out.weight[i]);
  tally(float(8 * kernel.size));
}

__global__ void __launch_bounds__(threads)
    blur_image_columns(MaskedSpans in, Span<const float> kernel, int width, Span<float> out) {
  const std::size_t i = global_thread();
  if (i >= in.value.size) return;
  const auto x = i % std::size_t(width), y = i / std::size_t(width), height = in.value.size / std::size_t(width);
  float value, weight;
  pcss::blur_at(in.value, in.weight, kernel, int(kernel.size) - 1, true, x, std::size_t(width), int(y), int(height),
                value, weight);
  out[i] = weight > 0.0f ? value / weight : 1.0f;
  tally(float(8 * kernel.size));
}

// NOLINTEND(misc-definitions-in-headers)
}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
