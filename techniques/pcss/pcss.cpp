#include "techniques/pcss/pcss.h"

#include "techniques/pcss/simd.h"

namespace penumbra {
namespace pcss {

SoftOptions pcss_options(const Parameters& p) {
  SoftOptions options;
  options.filter_scale = float(p.number("filter_scale"));
  return options;
}

}  // namespace pcss

void register_pcss(Registry& registry) {
  Entry entry =
      shadow_map::AreaShadow::entry({shadow_map::region_bias_parameter(), shadow_map::filter_scale_parameter()});
  entry.name = "pcss";
  entry.summary = "percentage-closer soft shadows: every texel of both regions";
  entry.citation = "Fernando 2005; Zhu et al. 2019, section 1";
  entry.kernels.emplace();
  pcss::add_member<pcss::pcss_options>(registry, std::move(entry));
}

}  // namespace penumbra
