// shadow-map-traced: rays from points of the lamp to the receiver, walked over the one shadow map of the lamp's centre,
// as game engines and real-time previews trace theirs.
//
// A ray from the lamp's point s to a receiver of depth d lies at depth z over the texel W(z) s from the receiver's own,
// W the light's width of light_view.h. Its steps are even on the map, each somewhere within its own part, and end at
// the receiver. It hits where it was in front of the stored surface and now is behind it. Where it comes behind a
// surface that it never was in front of, that one hides what it could meet: the surface that it saw last is continued
// with its last slope, and it hits where it comes behind that.
#pragma once

#include <limits>

#include "techniques/bases/shadow_map/area_shadow.h"
#include "techniques/bases/shadow_map/turned_samples.h"

namespace penumbra::shadow_map_traced {
using namespace shadow_map;  // NOLINT: its base

struct Walking {
  int steps = 8;
  float slope = 1.0f;      ///< most that a surface recedes or comes nearer, m per m of the ray's own depth
  float thickness = 0.0f;  ///< of what is stored, m: a ray that comes behind it no farther than this hits
  float jitter = 1.0f;     ///< share of a step's part that its place is spread over
};

/// A ray on its way.
struct Walk {
  float depth = 0.0f;    ///< where it is, m
  float surface = 0.0f;  ///< depth of the surface below it, stored or continued
  float slope = 0.0f;    ///< of that, m per m
  bool hit = false;
};

/// To depth z > walk.depth, over a texel that stores `stored`; infinity where nothing is.
PENUMBRA_HD inline void step(const Walking& how, float z, float stored, Walk& walk) {
  const float advance = z - walk.depth, continued = walk.surface + walk.slope * advance;
  if (z > stored) {
    walk.hit = walk.hit || walk.depth <= stored + how.thickness || z > continued;
    walk.surface = continued;
  } else {
    const float change = stored - walk.surface, most = how.slope * advance;
    const bool both = change < 3e38f && change > -3e38f && advance > 0.0f;  // neither is infinite
    const float limited = change > most ? most : change < -most ? -most : change;
    walk.slope = both ? limited / advance : 0.0f;
    walk.surface = stored;
  }
  walk.depth = z;
}

/// Depth of a ray that has still the share f of its way on the map before it, `near` where it began.
PENUMBRA_HD inline float depth_at(const LightView& view, float near, float d, float f) {
  return view.perspective ? 1.0f / (1.0f / d + f * (1.0f / near - 1.0f / d)) : d - f * (d - near);
}

/// Where within its part a step of ray number `ray` lies, in [0, 1), for a receiver's random number in [0, 1).
PENUMBRA_HD inline float place_in_step(const Walking& how, int ray, float random) {
  const float turned = random + 0.61803399f * float(ray);
  return 0.5f + how.jitter * (turned - std::floor(turned) - 0.5f);
}

/// The random number of the steps of the receiver in column x and row y of its image.
PENUMBRA_HD inline float step_number(int x, int y) {
  return random_triple(std::uint64_t(y) << 32 | std::uint32_t(x), 1).x;
}

/// The depth that `map` stores at (x, y); outside of it nothing is.
template <class Map>
PENUMBRA_HD inline float stored(const Map& map, float x, float y) {
  const auto edge = float(map.resolution());
  if (!(x >= 0.0f && y >= 0.0f && x < edge && y < edge)) return std::numeric_limits<float>::infinity();
  return map.at(int(x), int(y));
}

/// Does ray number `ray`, from the lamp's `point` (placed()), hit anything before it comes to the receiver?
template <class Map>
PENUMBRA_HD inline bool walk(const Walking& how, const LightView& view, const Map& map, const Projected& receiver,
                             int ray, vec2 point, float random) {
  const float near = view.near, d = receiver.depth, whole = view.region(near, d);
  const float place = place_in_step(how, ray, random);
  Walk walk{near, std::numeric_limits<float>::infinity(), 0.0f, false};
  for (int k = how.steps; k-- > 0 && !walk.hit;) {
    const float f = (float(k) + place) / float(how.steps), across = f * whole;
    step(how, depth_at(view, near, d, f), stored(map, receiver.x + across * point.x, receiver.y + across * point.y),
         walk);
  }
  if (!walk.hit) step(how, d, stored(map, receiver.x, receiver.y), walk);
  return walk.hit;
}

/// Share of the rays from `points` of the lamp, turned by (u, v) and in steps by `random`, that come to a receiver.
template <class Map, class Points>
PENUMBRA_HD inline float share_of_rays(const Walking& how, const LightView& view, const Map& map,
                                       const Projected& receiver, Pattern kind, const Points& points, int count,
                                       float u, float v, float random) {
  int hits = 0;
  const bool below = receiver.depth > view.near;
  for (int ray = 0; below && ray < count; ++ray)
    hits += walk(how, view, map, receiver, ray, placed(kind, points[std::size_t(ray)], u, v), random);
  return 1.0f - float(hits) / float(count);
}

/// What every receiver of a tile draws: turns of the lamp's points, and a random number for steps. Padded as tiles are.
struct Draws {
  Turns turns;
  std::vector<float> steps;
};

/// Finds the visibility of a tile's receivers, a lane a receiver.
void walk_tile(const ShadowMap& map, const Walking& how, Pattern kind, const std::vector<vec2>& points,
               const Draws& draws, Tile& tile);

class Traced : public AreaShadow {
 public:
  explicit Traced(const Parameters& p);

 protected:
  /// The lamp's points: of a disc or of a parallelogram.
  Pattern pattern() const { return lamp_.radius > 0.0f ? Pattern::vogel : Pattern::lattice; }
  const std::vector<vec2>& points() const { return lamp_.radius > 0.0f ? disc_ : square_; }

  void draw(const Tile& tile, Draws& draws) const;
  void find_visibility(Tile& tile) override;

  Walking how_;

 private:
  std::vector<vec2> square_, disc_;
};

}  // namespace penumbra::shadow_map_traced
