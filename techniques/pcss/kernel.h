// The vectorised steps of the family, compiled for every instruction set and dispatched at run time. They do the same
// operations in the same order as their scalar twins wherever a rounding could move a region's edge; none is fused.
//
//   point_kernel.cpp:  a lane is a receiver
//   region_kernel.cpp: a lane is a texel, a square or a sample of one receiver's region; image rows
#pragma once

#include "techniques/bases/area_irradiance.h"
#include "techniques/pcss/blur.h"
#include "techniques/pcss/moments.h"
#include "techniques/pcss/rotated.h"
#include "techniques/pcss/soft_shadow.h"

namespace penumbra::pcss::simd {

// --- a lane is a receiver --------------------------------------------------------------------------------------------

void find_unshadowed(const LampPolygon& lamp, const Receivers& receivers, int begin, int end, float* factor);
void project(const LightView& view, const Receivers& receivers, float bias, Tile& tile);
void hard_shadow(const ShadowMap& map, int kernel, Tile& tile);

/// Steps 1 and 3 of SoftShadow.
void search_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile);
void filter_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile);

/// Samples of RotatedShadow: mean blocker depth into tile.blocker, share of open ones into tile.visibility.
struct Turns {
  std::vector<float> u, v;
};
void rotated_blockers(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, Tile& tile);
void rotated_filter(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, float scale, Tile& tile);

/// Both steps of MomentShadow.
void moment_blockers(const LightView& view, const MomentTable& table, double bias, Tile& tile);
void moment_filter(const LightView& view, const MomentTable& table, double bias, float scale, Tile& tile);

// --- a lane is a texel -----------------------------------------------------------------------------------------------

Blockers blockers_of_texels(const ShadowMap& map, const Texels& texels, float d);

/// Where the samples of a leaf lie, in texels from its corner: [level][variant][16], row by row of one map.
class SampleOffsets {
 public:
  SampleOffsets() = default;
  SampleOffsets(const SampleImage& image, int map_edge);
  const std::int32_t* of(int level, int variant) const {
    return &offset_[std::size_t(level * SampleImage::variants + variant) * 16];
  }
  int map_edge() const { return map_edge_; }

 private:
  int map_edge_ = 0;
  std::vector<std::int32_t> offset_;
};

/// The quadtree's sums, its leaves looked at all at once: what is decided higher up is decided in every leaf below.
/// `depth` up to most_depth.
constexpr int most_depth = 4;
Blockers blockers_of_square(const MultiScaleMap& map, const SampleOffsets& samples, const Square& square, int depth,
                            float d, Sum how);

void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out);
void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out);

std::string target();

}  // namespace penumbra::pcss::simd
