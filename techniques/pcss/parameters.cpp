// Parameters of the soft shadows, and what they mean to the pipeline.
#include "techniques/pcss/soft_shadow.h"

namespace penumbra::pcss {
namespace {

using Parts = std::vector<std::vector<Parameter>>;

std::vector<Parameter> joined(const Parts& parts) {
  std::vector<Parameter> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Parameter scale_parameter() {
  return number_parameter("filter_scale", 1.0, 0.0, 16.0, "", "c: filter width over penumbra width");
}

/// The default of each choice comes first.
std::vector<Parameter> multi_scale_parameters(const std::vector<ParameterValue>& levels,
                                              const std::vector<ParameterValue>& snap_size,
                                              const std::vector<ParameterValue>& snap_place) {
  return {choice_parameter("levels", levels, "squares of the multi-scale map: all, or those on the map"),
          choice_parameter("build", {"needed", "all"}, "levels up to the widest region of the frame, or all"),
          choice_parameter("refine", {"on", "off"}, "shrink the search region by the least depth in it"),
          integer_parameter("depth", 3, 0, 14, "levels", "of the quadtree below a region; 14: single texels"),
          choice_parameter("snap_end", {"inclusive", "exclusive"}, "is texel ceil(x + s/2) part of a region?"),
          choice_parameter("snap_size", snap_size,
                           "a region's power of two: nearer, never smaller, or (refining) four squares that cover it"),
          choice_parameter("snap_place", snap_place, "what a region keeps when it is resized")};
}

Snapping read_snapping(const Parameters& p) {
  Snapping snapping;
  snapping.inclusive = p.text("snap_end") == "inclusive";
  snapping.size = p.text("snap_size") == "nearest" ? Snapping::Size::nearest : Snapping::Size::up;
  snapping.centred = p.text("snap_place") == "centre";
  return snapping;
}

Sum read_sum(const std::string& name) {
  return name == "texels" ? Sum::texels : name == "nearest" ? Sum::nearest : Sum::sampled;
}

void read_multi_scale(const Parameters& p, SoftOptions& options) {
  options.multi_scale = true;
  options.layout = p.text("levels") == "full" ? LevelLayout::full : LevelLayout::reduced;
  options.build_all = p.text("build") == "all";
  options.refine = p.text("refine") == "on";
  options.depth = p.integer("depth");
  options.snapping = read_snapping(p);
  options.overlap = p.text("snap_size") == "overlap";
  options.search = read_sum(p.text("search"));
}

Reuse read_reuse(const Parameters& p, const char* area) {
  Reuse reuse;
  reuse.area = p.integer(area);
  reuse.sigma_size = float(p.number("sigma_size"));
  reuse.sigma_place = float(p.number("sigma_place"));
  reuse.sigma_depth = float(p.number("sigma_depth"));
  reuse.place_by_size = p.text("similarity") == "size";
  reuse.literal = p.text("links") == "inside";
  return reuse;
}

}  // namespace

std::vector<Parameter> pcss_parameters() {
  return joined({AreaShadow::parameters(), {scale_parameter()}});
}

std::vector<Parameter> hqepcss_parameters() {
  return joined({pcss_parameters(),
                 multi_scale_parameters({"full", "reduced"}, {"up", "nearest", "overlap"}, {"centre", "corner"}),
                 {choice_parameter("search", {"nearest", "sampled", "texels"},
                                   "blocker depth: quadtree whose undecided leaves count at their least depth, or by "
                                   "samples; or every texel")}});
}

std::vector<Parameter> fast_pcss_parameters() {
  return joined(
      {pcss_parameters(),
       multi_scale_parameters({"reduced", "full"}, {"nearest", "up", "overlap"}, {"corner", "centre"}),
       {choice_parameter("search", {"sampled", "nearest", "texels"}, "blocker depth: see hqepcss"),
        choice_parameter("filter", {"sampled", "nearest", "texels"}, "shadow: the same for the filter region"),
        integer_parameter("search_area", 4, 1, 16, "receivers", "edge of areas that share blocker depths; 1: none"),
        integer_parameter("filter_area", 2, 1, 16, "receivers", "edge of areas that share shadows; 1: none"),
        choice_parameter("links", {"area", "inside"},
                         "inside: an area's first row and column stay alone (the paper's sentence)"),
        choice_parameter("similarity", {"coordinates", "size"}, "what distances of centres are relative to"),
        number_parameter("sigma_size", 0.0, 0.0, 1.0, "", "largest relative difference of sizes that share"),
        number_parameter("sigma_place", 0.1, 0.0, 1.0, "", "of centres"),
        number_parameter("sigma_depth", 0.1, 0.0, 1.0, "", "of depths"),
        integer_parameter("blur", 3, 0, most_blur, "receivers", "radius of the Gaussian; 0: none")}});
}

SoftOptions pcss_options(const Parameters& p) {
  SoftOptions options;
  options.filter_scale = float(p.number("filter_scale"));
  return options;
}

SoftOptions hqepcss_options(const Parameters& p) {
  SoftOptions options = pcss_options(p);
  read_multi_scale(p, options);
  return options;
}

SoftOptions fast_pcss_options(const Parameters& p) {
  SoftOptions options = hqepcss_options(p);
  options.filter = read_sum(p.text("filter"));
  options.search_reuse = read_reuse(p, "search_area");
  options.filter_reuse = read_reuse(p, "filter_area");
  options.blur = p.integer("blur");
  return options;
}

}  // namespace penumbra::pcss
