// The vectorised steps of the family, compiled for every instruction set and dispatched at run time. They do the same
// operations in the same order as their scalar twins wherever a rounding could move a region's edge; none is fused.
//
//   point_kernel.cpp, sample_kernel.cpp, moment_kernel.cpp: a lane is a receiver
//   region_kernel.cpp: a lane is a texel, a square or a sample of one receiver's region; image rows
#pragma once

#include "techniques/bases/area_irradiance.h"
#include "techniques/pcss/blur.h"
#include "techniques/pcss/moments.h"
#include "techniques/pcss/rotated.h"
#include "techniques/pcss/soft_shadow.h"

namespace penumbra::pcss::simd {

// --- a lane is a receiver --------------------------------------------------------------------------------------------

void find_unshadowed(const LampOutline& lamp, const Receivers& receivers, int begin, int end, float* factor);
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

/// The quadtree's sums. Without `depths` only texels are counted.
Blockers blockers_of_square(const ShadowMap& map, const MultiScaleMap& levels, const LeafSamples& samples,
                            const Square& square, int depth, float d, Sum how, bool depths);

void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out);
void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out);

std::string target();

}  // namespace penumbra::pcss::simd
