#include "techniques/pcss/pcss.h"

#include "techniques/pcss/hard_shadow.h"
#include "techniques/pcss/moment_shadow.h"
#include "techniques/pcss/rotated.h"
#include "techniques/pcss/simd.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

using namespace pcss;

struct Member {
  const char *name, *summary, *citation;
  std::vector<Parameter> parameters;
  Maker scalar, simd;
  std::vector<Knob> knobs;
  int reach = 0;
};

template <class Shadow>
Maker scalar() {
  return [](const Parameters& p) { return std::make_unique<Shadow>(p, false); };
}
Maker scalar_soft(SoftOptions (*options)(const Parameters&)) {
  return [options](const Parameters& p) { return std::make_unique<SoftShadow>(p, options(p), false); };
}

std::vector<Member> members() {
  const Knob map = {"map", {256, 512, 1024, 2048}};  // no more is always better: the bias shrinks with the texels
  const Knob search = {"search", {"sampled", "nearest", "texels"}};
  return {
      {"shadow-map",
       "hard shadow of the light's centre, or a fixed filter",
       "Williams 1978; Reeves et al. 1987",
       HardShadow::parameters(),
       scalar<HardShadow>(),
       simd_hard_shadow(),
       {map, {"kernel", {1, 3, 5, 9, 17, 33}}}},
      {"pcss",
       "percentage-closer soft shadows: every texel of both regions",
       "Fernando 2005; Zhu et al. 2019, section 1",
       pcss_parameters(),
       scalar_soft(pcss_options),
       simd_soft_shadow(pcss_options),
       {map}},
      {"hqepcss",
       "refined search region, blocker depth by a quadtree over a multi-scale map",
       "Shen et al. 2014",
       hqepcss_parameters(),
       scalar_soft(hqepcss_options),
       simd_soft_shadow(hqepcss_options),
       {map, search}},
      {"fast-pcss",
       "reduced multi-scale map, sampled quadtrees, results shared by neighbours, blur",
       "Zhu et al. 2019",
       fast_pcss_parameters(),
       scalar_soft(fast_pcss_options),
       simd_soft_shadow(fast_pcss_options),
       {map, search, {"blur", {0, 3}}},
       most_blur},
      {"pcss-rotated",
       "few samples in both regions, turned at every receiver",
       "Fernando 2005; Jimenez 2014 (interleaved gradient noise)",
       RotatedShadow::parameters(),
       scalar<RotatedShadow>(),
       simd_rotated_shadow(),
       {map, {"filter_samples", {8, 12, 16, 24, 32, 48, 64, 96, 128}, true}}},
      {"moment-shadows",
       "both regions in constant time by four moments in a summed-area table",
       "Peters & Klein 2015; Peters et al. 2016",
       MomentShadow::parameters(),
       scalar<MomentShadow>(),
       simd_moment_shadow(),
       {map}},
  };
}

}  // namespace

void register_pcss(Registry& registry) {
  for (const Member& member : members())
    for (const bool simd : {false, true}) {
      Entry entry;
      entry.name = member.name;
      entry.backend = simd ? "simd" : "scalar";
      entry.summary = member.summary;
      entry.citation = member.citation;
      entry.lights = {false, true};
      entry.reads_spheres = [](const Parameters&) { return false; };
      entry.parameters = member.parameters;
      entry.make = simd ? member.simd : member.scalar;
      entry.reach = member.reach;
      entry.knobs = member.knobs;
      entry.errs_by = "one view";
      entry.parity = 1e-3;  // a rounding may move a region's edge by a texel
      registry.add(std::move(entry));
    }
}

}  // namespace penumbra
