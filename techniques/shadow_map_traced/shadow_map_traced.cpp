#include "techniques/shadow_map_traced/shadow_map_traced.h"

#include "techniques/bases/random.h"
#include "techniques/bases/shadow_map/simd.h"

namespace penumbra {
namespace shadow_map_traced {
namespace {

class Traced : public AreaShadow {
 public:
  explicit Traced(const Parameters& p)
      : AreaShadow(p),
        how_{p.integer("steps"), float(p.number("slope")), float(p.number("thickness")), float(p.number("jitter"))},
        square_(make_samples(Pattern::lattice, p.integer("rays"))),
        disc_(make_samples(Pattern::vogel, p.integer("rays"))) {}

 protected:
  Pattern pattern() const { return lamp_.radius > 0.0f ? Pattern::vogel : Pattern::lattice; }
  const std::vector<vec2>& points() const { return lamp_.radius > 0.0f ? disc_ : square_; }

  void draw(const Tile& tile, Draws& draws) const {
    find_turns(pattern(), tile, draws.turns);
    draws.steps.resize(draws.turns.u.size());
    for (int k = 0; k < tile.size(); ++k) {
      const int x = tile.column + k % tile.columns, y = tile.row + k / tile.columns;
      draws.steps[k] = random_triple(std::uint64_t(y) << 32 | std::uint32_t(x), 1).x;
    }
  }

  void find_visibility(Tile& tile) override {
    Draws draws;
    timed(project_part, [&] { draw(tile, draws); });
    timed(filter_part, [&] {
      for (int k = 0; k < tile.size(); ++k) {
        int hits = 0;
        const bool below = tile.depth[k] > map_.view.near;
        for (int ray = 0; below && ray < int(points().size()); ++ray)
          hits += walk(tile.at(k), ray, placed(pattern(), points()[ray], draws.turns.u[k], draws.turns.v[k]),
                       draws.steps[k]);
        tile.visibility[k] = 1.0f - float(hits) / float(points().size());
      }
    });
  }

  Walking how_;

 private:
  float stored(float x, float y) const {  // outside the map nothing is
    const float edge = float(map_.resolution());
    if (!(x >= 0.0f && y >= 0.0f && x < edge && y < edge)) return std::numeric_limits<float>::infinity();
    return map_.at(int(x), int(y));
  }

  bool walk(const Projected& receiver, int ray, vec2 point, float random) const {
    const LightView& view = map_.view;
    const float near = view.near, d = receiver.depth, whole = view.region(near, d);
    const float place = place_in_step(how_, ray, random);
    Walk walk{near, std::numeric_limits<float>::infinity(), 0.0f, false};
    for (int k = how_.steps; k-- > 0 && !walk.hit;) {
      const float f = (float(k) + place) / float(how_.steps), across = f * whole;
      step(how_, depth_at(view, near, d, f), stored(receiver.x + across * point.x, receiver.y + across * point.y),
           walk);
    }
    if (!walk.hit) step(how_, d, stored(receiver.x, receiver.y), walk);
    return walk.hit;
  }

  std::vector<vec2> square_, disc_;
};

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
  add_pair<shadow_map_traced::Traced, shadow_map_traced::TracedSimd>(registry, std::move(entry));
}

}  // namespace penumbra
