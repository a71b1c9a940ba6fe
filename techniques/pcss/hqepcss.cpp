// hqepcss, and what it shares with fast-pcss: the parameters of a multi-scale map.
#include "techniques/pcss/simd.h"

namespace penumbra {
namespace pcss {

Entry multi_scale_entry(const MultiScaleChoices& choices, const std::vector<Parameter>& own) {
  std::vector<Parameter> parameters = {
      region_bias_parameter(),
      filter_scale_parameter(),
      choice_parameter("levels", choices.levels,
                       "squares of the multi-scale map; full: at every offset, reduced: those that lie on the map"),
      choice_parameter("build", {"needed", "all"},
                       "levels of the multi-scale map; needed: up to the widest region of the frame"),
      choice_parameter("refine", {"on", "off"}, "shrink the search region by the least depth in it"),
      integer_parameter("depth", 3, 0, 14, "levels", "depth of the quadtree below a region; 14: single texels"),
      choice_parameter("snap_end", {"inclusive", "exclusive"}, "is texel ceil(x + s/2) part of a region?"),
      choice_parameter("snap_size", choices.snap_size,
                       "a region's power of two: nearer, never smaller, or (refining) four squares that cover it"),
      choice_parameter("snap_place", choices.snap_place, "what a region keeps when it is resized"),
      choice_parameter("search", choices.search,
                       "blocker depth: quadtree whose undecided leaves count at their least depth, or by samples; or "
                       "every texel")};
  parameters.insert(parameters.end(), own.begin(), own.end());
  Entry entry = AreaShadow::entry(parameters);
  entry.kernels.emplace();
  for (const Parameter& p : parameters)
    if (p.name == "search" || p.name == "filter")
      for (std::size_t k = 1; k < p.allowed.size(); ++k)
        entry.kernels->workloads.emplace_back().set(p.name, p.allowed[k]);
  entry.knobs.push_back({"search", {"sampled", "nearest", "texels"}});
  return entry;
}

SoftOptions hqepcss_options(const Parameters& p) {
  SoftOptions options = pcss_options(p);
  options.multi_scale = true;
  options.layout = p.text("levels") == "full" ? LevelLayout::full : LevelLayout::reduced;
  options.build_all = p.text("build") == "all";
  options.refine = p.text("refine") == "on";
  options.depth = p.integer("depth");
  options.snapping.inclusive = p.text("snap_end") == "inclusive";
  options.snapping.centred = p.text("snap_place") == "centre";
  const std::string& size = p.text("snap_size");
  options.snapping.size = size == "nearest" ? Snapping::Size::nearest
                          : size == "up"    ? Snapping::Size::up
                                            : Snapping::Size::overlap;
  options.search = read_sum(p.text("search"));
  return options;
}

}  // namespace pcss

void register_hqepcss(Registry& registry) {
  Entry entry = pcss::multi_scale_entry(
      {{"full", "reduced"}, {"up", "nearest", "overlap"}, {"centre", "corner"}, {"nearest", "sampled", "texels"}});
  entry.name = "hqepcss";
  entry.summary = "refined search region, blocker depth by a quadtree over a multi-scale map";
  entry.citation = "Shen et al. 2014";
  pcss::add_member<pcss::hqepcss_options>(registry, std::move(entry));
}

}  // namespace penumbra
