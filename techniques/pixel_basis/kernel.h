// The vectorised inner loops of pixel-basis, compiled for every instruction set and dispatched at run time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "techniques/bases/blocked.h"
#include "techniques/technique.h"

namespace penumbra::pixel_basis {

/// L dw / pi of every texel, by channel.
struct LightEnergy {
  std::vector<float> channel[3];
  void assign(const CubeLight& light);
};

/// Everything that depends on the normal alone: p_t L_t dw_t, and its sums over words and lines.
struct NormalWeights {
  vec3 normal{0.0f};
  std::uint64_t active = 0;  ///< lines with a texel above the horizon
  std::vector<float> texel[3];
  std::vector<float> word[3];  ///< sums over 32 texels
  std::vector<vec3> line;      ///< sums over 512 texels
  void assign(const LightEnergy& light, const LineCones& cones, vec3 unit_normal);
};

struct Job {
  BlockedJob blocked;
  const LightEnergy* light;
  const std::vector<NormalWeights>* weights;    ///< empty: normals differ too much, weigh texels on the fly
  const std::vector<std::uint16_t>* weight_of;  ///< index into weights per receiver
};

/// Shades the receivers that are [begin, end) in the job's order.
void shade(const Job& job, int begin, int end, vec3* radiance);

/// Name of the instruction set that shade() runs on.
std::string target();

}  // namespace penumbra::pixel_basis
