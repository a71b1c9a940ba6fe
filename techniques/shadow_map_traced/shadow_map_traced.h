// shadow-map-traced: rays from points of the lamp to the receiver, walked over the one shadow map of the lamp's centre,
// as game engines and real-time previews trace theirs.
//
// A ray from the lamp's point s to a receiver of depth d lies at depth z over the texel W(z) s from the receiver's own,
// W the light's width of light_view.h. Its steps are even on the map, each somewhere within its own part, and end at
// the receiver. It hits where it was in front of the stored surface and now is behind it. Where it comes behind a
// surface that it never was in front of, that one hides what it could meet: the surface that it saw last is continued
// with its last slope, and it hits where it comes behind that.
#pragma once

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

/// What every receiver of a tile draws: turns of the lamp's points, and a random number for steps. Padded as tiles are.
struct Draws {
  Turns turns;
  std::vector<float> steps;
};

/// Finds the visibility of a tile's receivers, a lane a receiver.
void walk_tile(const ShadowMap& map, const Walking& how, Pattern kind, const std::vector<vec2>& points,
               const Draws& draws, Tile& tile);

}  // namespace penumbra::shadow_map_traced
