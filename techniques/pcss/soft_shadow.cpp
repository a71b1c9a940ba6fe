#include "techniques/pcss/soft_shadow.h"

#include <algorithm>
#include <numeric>

#include "techniques/bases/for_ranges.h"

namespace penumbra::pcss {

int needed_level(float width, int edge) {
  const int texels = int(std::min(std::ceil(std::max(width, 0.0f)) + 2.0f, float(edge)));
  return std::min(snapped_level(texels, Snapping::Size::up), largest_level(edge));
}

SoftShadow::SoftShadow(const Parameters& parameters, const SoftOptions& options)
    : AreaShadow(parameters, float(parameters.number("region_bias"))),
      options_(options),
      kernel_(gaussian(options.blur)) {}

int SoftShadow::tile_multiple() const {
  return std::lcm(options_.search_reuse.area, options_.filter_reuse.area);
}

int SoftShadow::largest_needed() const {
  const LightView& view = map_.view;
  const float widest = std::max(1.0f, options_.filter_scale) * view.widest();
  return options_.build_all ? largest_level(view.resolution) : needed_level(widest, view.resolution);
}

void SoftShadow::map_changed() {
  if (!options_.multi_scale) return;
  if (samples_.stride() != map_.stride()) samples_ = LeafSamples(make_sample_image(), map_);
  clock_.measure("levels", [&] { levels_.build(map_, options_.layout, largest_needed()); });
}

// --- step 1: search regions ------------------------------------------------------------------------------------------

void SoftShadow::find_regions(Tile& tile) const {
  for (int k = 0; k < tile.size(); ++k) {
    const Region region = search_region(map_.view, levels_, options_, tile.at(k));
    tile.width[k] = region.width, tile.square[k] = region.square;
    tile.representative[k] = region.lit ? -1 : k;
  }
}

// --- steps 2 and 4: blockers in a region -----------------------------------------------------------------------------

Blockers SoftShadow::blockers_in(const Tile& tile, int k, Sum how, bool depths) const {
  const float d = blocking_depth(tile.depth[k], tile.rise[k], tile.width[k]);
  if (how == Sum::texels) return blockers_of_texels(map_, texels_of(tile.x[k], tile.y[k], tile.width[k]), d);
  const Square& square = tile.square[k];
  const int leaf_level = std::max(0, square.level - options_.depth);
  Blockers found;
  const auto sum = [&](const auto& leaf) {
    if (depths) traverse<true>(levels_, square, leaf_level, d, leaf, found);
    else traverse<false>(levels_, square, leaf_level, d, leaf, found);
  };
  if (how == Sum::nearest) sum(nearest_leaf);
  else sum([&](const Square& leaf, const DepthRange&) { return sampled_leaf(map_, samples_, leaf, d); });
  return found;
}

void SoftShadow::find_blockers(Tile& tile) const {
  for (int k = 0; k < tile.size(); ++k)
    if (tile.representative[k] == k) tile.blocker[k] = blockers_in(tile, k, options_.search, true).mean();
}

void SoftShadow::filter(Tile& tile) const {
  for (int k = 0; k < tile.size(); ++k) {
    if (tile.representative[k] != k) continue;
    const float blocked = blockers_in(tile, k, options_.filter, false).count;
    const float all = options_.filter == Sum::texels ? float(texels_of(tile.x[k], tile.y[k], tile.width[k]).count())
                                                     : float(tile.square[k].edge() * tile.square[k].edge());
    tile.visibility[k] = 1.0f - blocked / all;
  }
}

// --- step 3, and the order of things ---------------------------------------------------------------------------------

void SoftShadow::make_filter_regions(Tile& tile) const {
  for (int k = 0; k < tile.size(); ++k) {
    tile.visibility[k] = 1.0f;
    if (tile.representative[k] < 0) continue;
    tile.blocker[k] = tile.blocker[tile.representative[k]];
    const Region region = filter_region(map_.view, levels_.largest(), options_, tile.at(k), tile.blocker[k]);
    tile.width[k] = region.width, tile.square[k] = region.square;
    tile.representative[k] = region.lit ? -1 : k;
  }
}

void SoftShadow::find_visibility(Tile& tile) {
  timed(region_part, [&] {
    find_regions(tile);
    if (options_.search_reuse.area > 1) link(options_.search_reuse, tile);
  });
  timed(blocker_part, [&] { find_blockers(tile); });
  timed(filter_part, [&] {
    make_filter_regions(tile);
    if (options_.filter_reuse.area > 1) link(options_.filter_reuse, tile);
    filter(tile);
    for (int k = 0; k < tile.size(); ++k)
      if (tile.representative[k] >= 0) tile.visibility[k] = tile.visibility[tile.representative[k]];
  });
}

void SoftShadow::blur_image(const MaskedImage& image, MaskedImage& between, std::vector<float>& out) const {
  for_ranges(image.height, 8, [&](int begin, int end) { blur_rows(image, kernel_, begin, end, between); });
  for_ranges(image.height, 8, [&](int begin, int end) { blur_columns(between, kernel_, begin, end, out.data()); });
}

void SoftShadow::finish(std::vector<float>& visibility) {
  if (options_.blur == 0) return;
  clock_.measure("blur", [&] {
    for (MaskedImage* image : {&image_, &between_}) {
      image->width = receivers_->width, image->height = receivers_->height;
      image->value.resize(visibility.size()), image->weight.resize(visibility.size());
    }
    image_.value.swap(visibility);
    for (int i = 0; i < receivers_->size(); ++i) image_.weight[i] = receivers_->valid(i) ? 1.0f : 0.0f;
    blur_image(image_, between_, visibility);
  });
}

}  // namespace penumbra::pcss
