#include "techniques/pcss/simd.h"

namespace penumbra {
namespace pcss {
namespace {

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

SoftOptions fast_pcss_options(const Parameters& p) {
  SoftOptions options = hqepcss_options(p);
  options.filter = read_sum(p.text("filter"));
  options.search_reuse = read_reuse(p, "search_area");
  options.filter_reuse = read_reuse(p, "filter_area");
  options.blur = p.integer("blur");
  return options;
}

}  // namespace pcss

void register_fast_pcss(Registry& registry) {
  Entry entry = pcss::multi_scale_entry(
      {{"reduced", "full"}, {"nearest", "up", "overlap"}, {"corner", "centre"}, {"sampled", "nearest", "texels"}},
      {choice_parameter("filter", {"sampled", "nearest", "texels"},
                        "shadow: quadtree whose undecided leaves count by samples, or as a whole; or every texel"),
       integer_parameter("search_area", 4, 1, 16, "receivers", "edge of areas that share blocker depths; 1: none"),
       integer_parameter("filter_area", 2, 1, 16, "receivers", "edge of areas that share shadows; 1: none"),
       choice_parameter("links", {"area", "inside"},
                        "who shares; inside: an area's first row and column stay alone (the paper's sentence)"),
       choice_parameter("similarity", {"coordinates", "size"}, "what distances of regions' centres are relative to"),
       number_parameter("sigma_size", 0.0, 0.0, 1.0, "", "largest relative difference of sizes that share"),
       number_parameter("sigma_place", 0.1, 0.0, 1.0, "", "largest relative distance of centres that share"),
       number_parameter("sigma_depth", 0.1, 0.0, 1.0, "", "largest relative difference of depths that share"),
       integer_parameter("blur", 3, 0, pcss::most_blur, "receivers", "radius of the Gaussian blur; 0: none")});
  entry.name = "fast-pcss";
  entry.summary = "reduced multi-scale map, sampled quadtrees, results shared by neighbours, blur";
  entry.citation = "Zhu et al. 2019";
  entry.knobs.push_back({"blur", {0, 3}});
  entry.reach = pcss::most_blur;
  pcss::add_member<pcss::fast_pcss_options>(registry, std::move(entry));
}

}  // namespace penumbra
