// Integration in the pixel basis: B = sum over open texels of L_t p_t dw_t (the ground truth of Zhao & Che 2011).
#pragma once

#include "scenes/light.h"
#include "scenes/ray_scene.h"
#include "techniques/bases/bit_cube.h"

namespace penumbra {

/// A light sampled at 6 x n x n texels.
struct CubeLight {
  int n = 0;
  std::vector<vec3> directions;  ///< unit texel centres
  std::vector<vec3> radiance;    ///< mean over the texel, W m^-2 sr^-1
  std::vector<float> solid_angle;

  CubeLight() = default;
  CubeLight(const Environment& environment, int edge);
  explicit CubeLight(CubeMap<vec3> cube);
  int size() const { return int(directions.size()); }
};

/// Reflected radiance of a diffuse receiver, summed in double over the texels that are not blocked. Blocked ones are
/// skipped, not multiplied by zero, so that they cannot leave a residue.
vec3 pixel_sum(const CubeLight& light, const BitCube& blocked, vec3 normal, vec3 albedo);

/// One ray from `origin` per texel centre above the normal's horizon; sets the bits of those that hit. `packets` traces
/// 16 at a time.
void trace_texels(const RayScene& rays, vec3 origin, vec3 normal, const std::vector<vec3>& directions, bool packets,
                  BitCube& blocked);

}  // namespace penumbra
