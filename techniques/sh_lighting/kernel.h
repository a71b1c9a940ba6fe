// The vectorised sums of sh-lighting: over coefficients, which lie side by side.
#pragma once

#include <array>

#include "techniques/sh_lighting/transfer.h"
#include "techniques/technique.h"

namespace penumbra::sh_lighting {

constexpr int row_multiple = 4;  ///< rows of coefficients are padded to as many floats

/// A direction that meets the mesh: the vertices around the point and their weights there.
struct Bounce {
  int direction;
  uvec3 vertex;
  vec3 weight;
};

/// out += scale * sum over the chosen directions of (normal . w) Y(w); one row.
void add_directions(const DirectionSet& set, vec3 normal, const std::vector<int>& chosen, float scale, float* out);

/// out += set.weight() * sum over bounces of (normal . w) * (weighted rows of the vertices); three rows.
void add_bounces(const DirectionSet& set, vec3 normal, const std::vector<Bounce>& bounces,
                 const TransferVectors& vertices, float* out);

/// radiance = albedo * light . transfer for receivers [begin, end); light: a row per channel.
void shade(const TransferVectors& transfer, const std::array<std::vector<float>, 3>& light,
           const std::vector<vec3>& albedo, int begin, int end, vec3* radiance);

}  // namespace penumbra::sh_lighting
