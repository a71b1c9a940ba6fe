// Diffuse transfer: what a receiver makes of each basis function of the light (Sloan et al. 2002; Green 2003).
//
//   T_i = 1/pi integral of V(w) max(0, N . w) Y_i(w) dw,  reflected radiance at albedo 1 = sum of L_i T_i
//
// estimated over M stratified directions, the same for every receiver. With bounces, blocked directions bring what the
// mesh reflects there: T_i += 1/pi integral of (1 - V) albedo T_i(x') max(0, N . w) dw, x' the point that is hit.
#pragma once

#include <span>

#include "scenes/ray_scene.h"
#include "scenes/receivers.h"

namespace penumbra::sh_lighting {

enum class Transfer { unshadowed, shadowed, interreflected };
enum class Estimator { complement, plain };

/// M directions and the basis in each.
struct DirectionSet {
  int order, row;                ///< row: coefficients, rounded up to whole vectors
  std::vector<vec3> directions;  ///< 4 x 4 neighbouring strata one after the other
  std::vector<float> basis;      ///< [direction][row], zero beyond order^2

  DirectionSet(int order, int count, std::uint64_t seed);
  float weight() const { return 4.0f / float(directions.size()); }  ///< of a direction, sr / pi
  std::size_t bytes() const { return directions.size() * sizeof(vec3) + basis.size() * sizeof(float); }
};

struct Request {
  Transfer transfer = Transfer::shadowed;
  Estimator estimator = Estimator::complement;
  int bounces = 1;
  vec3 mesh_albedo{1.0f};  ///< of what is hit
  bool packets = true;     ///< vectorised, or one ray and one number at a time
};

/// Vectors of many points, [point][channel][row]; one channel, or three where light was reflected by a coloured mesh.
struct TransferVectors {
  int channels = 1, row = 0;
  std::vector<float> values;
  float* at(std::size_t point, int channel = 0) { return &values[(point * channels + channel) * row]; }
  const float* at(std::size_t point, int channel = 0) const { return &values[(point * channels + channel) * row]; }
};

/// Transfer of every receiver. `rays` holds `mesh`. Receivers with a zero normal get zeros.
TransferVectors compute_transfer(const Request& request, const DirectionSet& set, const RayScene& rays,
                                 const Mesh& mesh, const Receivers& receivers);

/// Directions above the horizon of receivers [begin, end) that the mesh blocks: a bit each, receivers one after the
/// other in whole words. Rays of neighbours in packets, in parallel.
std::vector<std::uint32_t> blocked_directions(const DirectionSet& set, const RayScene& rays, const Receivers& receivers,
                                              int begin, int end);
inline std::size_t words_of(const DirectionSet& set) {
  return (set.directions.size() + 31) / 32;
}

}  // namespace penumbra::sh_lighting
