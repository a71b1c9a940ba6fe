// The vectorised inner loops of pixel-basis, compiled for every instruction set and dispatched at run time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "techniques/bases/pixel_sum.h"
#include "techniques/bases/sphere_table.h"
#include "techniques/technique.h"

namespace penumbra::pixel_basis {

/// Spheres as separate coordinates, padded with radius 0 to a multiple of 16.
struct SphereLanes {
  std::vector<float> x, y, z, radius;
  void assign(const SphereSet& set);
  int padded() const { return int(x.size()); }
};

/// A light as separate channels, and the geometry of lines.
struct LightLanes {
  int n = 0;
  std::vector<float> direction[3];  ///< texel centres
  std::vector<float> energy[3];     ///< L dw / pi
  std::vector<vec3> line_axis;      ///< bounding cone of each line of 512 texels
  std::vector<float> line_sine, line_cosine;
  void assign(const CubeLight& light);
};

/// Everything that depends on the normal alone: p_t L_t dw_t, and its sums over words and lines.
struct NormalWeights {
  vec3 normal{0.0f};
  std::uint64_t active = 0;  ///< lines with a texel above the horizon
  std::vector<float> texel[3];
  std::vector<float> word[3];  ///< sums over 32 texels
  std::vector<vec3> line;      ///< sums over 512 texels
  void assign(const LightLanes& light, vec3 unit_normal);
};

struct Job {
  const Receivers* receivers;
  const SphereLanes* spheres;
  const LightLanes* light;
  const SphereTable* table;                    ///< null: rasterise exactly
  const RayScene* rays;                        ///< not null: trace the mesh instead of spheres
  const std::vector<vec3>* directions;         ///< for rays
  const std::vector<NormalWeights>* weights;   ///< empty: normals differ too much, weigh texels on the fly
  const std::vector<std::uint8_t>* weight_of;  ///< index into weights per receiver
};

/// Shades receivers [begin, end).
void shade(const Job& job, int begin, int end, vec3* radiance);

/// Name of the instruction set that shade() runs on.
std::string target();

}  // namespace penumbra::pixel_basis
