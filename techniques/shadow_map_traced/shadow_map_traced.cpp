#include "techniques/shadow_map_traced/shadow_map_traced.h"

#include "techniques/bases/shadow_map/simd.h"

namespace penumbra {
namespace shadow_map_traced {

Traced::Traced(const Parameters& p)
    : AreaShadow(p),
      how_{p.integer("steps"), float(p.number("slope")), float(p.number("thickness")), float(p.number("jitter"))},
      square_(make_samples(Pattern::lattice, p.integer("rays"))),
      disc_(make_samples(Pattern::vogel, p.integer("rays"))) {}

void Traced::draw(const Tile& tile, Draws& draws) const {
  find_turns(pattern(), tile, draws.turns);
  draws.steps.resize(draws.turns.u.size());
  for (int k = 0; k < tile.size(); ++k)
    draws.steps[k] = step_number(tile.column + k % tile.columns, tile.row + k / tile.columns);
}

void Traced::find_visibility(Tile& tile) {
  Draws draws;
  timed(project_part, [&] { draw(tile, draws); });
  timed(filter_part, [&] {
    const Pattern kind = pattern();
    const std::vector<vec2>& all = points();
    for (int k = 0; k < tile.size(); ++k)
      tile.visibility[k] = share_of_rays(how_, map_.view, map_, tile.at(k), kind, all, int(all.size()),
                                         draws.turns.u[k], draws.turns.v[k], draws.steps[k]);
  });
}

namespace {

class TracedSimd final : public Simd<Traced> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    thread_local Draws draws;
    timed(project_part, [&] { draw(tile, draws); });
    timed(filter_part, [&] { walk_tile(map_, how_, pattern(), points(), draws, tile); });
  }
};

}  // namespace
}  // namespace shadow_map_traced

void register_shadow_map_traced(Registry& registry) {
  Entry entry = shadow_map::AreaShadow::entry(
      {integer_parameter("rays", 8, 1, 1024, "rays", "points of the lamp that every receiver asks"),
       integer_parameter("steps", 8, 1, 1024, "steps", "looks at the map along a ray, besides the receiver's own"),
       number_parameter("slope", 1.0, 0.0, 1e3, "", "most that a hidden surface is continued by, m per m of depth"),
       number_parameter("thickness", 0.0, 0.0, 1e6, "m",
                        "of what the map holds: it stops rays that come so far behind it"),
       number_parameter("jitter", 1.0, 0.0, 1.0, "steps",
                        "how far steps are moved at random; 0: noise becomes bands")});
  entry.name = "shadow-map-traced";
  entry.summary = "rays to points of the lamp, walked over the one shadow map of its centre";
  entry.citation = "as shipped in Unreal Engine 5 (virtual shadow maps) and Blender 4.2 (EEVEE)";
  entry.knobs.push_back({"rays", {1, 2, 4, 8, 16, 32, 64}, true});
  entry.knobs.push_back({"steps", {4, 8, 16}});
  entry.kernels.emplace();
  add_pair<shadow_map_traced::Traced, shadow_map_traced::TracedSimd>(registry, std::move(entry));
}

}  // namespace penumbra
