// The vectorised steps of the pipeline, compiled for every instruction set and dispatched at run time. They do the same
// operations in the same order as their scalar twins wherever a rounding could move a region's edge; none is fused.
//
//   point_kernel.cpp: a lane is a receiver
//   region_kernel.cpp: a lane is a texel, a square or a sample of one receiver's region; image rows
#pragma once

#include "techniques/pcss/soft_shadow.h"

namespace penumbra::pcss::simd {

// --- a lane is a receiver --------------------------------------------------------------------------------------------

/// Steps 1 and 3 of SoftShadow.
void search_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile);
void filter_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile);

// --- a lane is a texel -----------------------------------------------------------------------------------------------

Blockers blockers_of_texels(const ShadowMap& map, const Texels& texels, float d);

/// The quadtree's sums. Without `depths` only texels are counted.
Blockers blockers_of_square(const ShadowMap& map, const MultiScaleMap& levels, const LeafSamples& samples,
                            const Square& square, int depth, float d, Sum how, bool depths);

void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out);
void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out);

}  // namespace penumbra::pcss::simd
