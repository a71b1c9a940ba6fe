#include "techniques/sh_exponentiation/attribution.h"

#include <tbb/parallel_for.h>

#include "scenes/ray_scene.h"
#include "techniques/bases/pixel_sum.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/tensor.h"

namespace penumbra::sh_exponentiation {
namespace {

constexpr int texel_edge = 32;

/// The texels of a cube map, the light in them, and the basis times solid angle.
struct Texels {
  CubeLight light;
  std::vector<float> basis;  ///< [texel][coefficient]

  Texels(int order, const std::array<std::vector<float>, 3>& bands) : light(CubeMap<vec3>(texel_edge, vec3(0.0f))) {
    const auto size = std::size_t(sh::coefficients(order));
    for (int t = 0; t < light.size(); ++t) {
      const std::vector<double> y = sh::evaluate(order, light.directions[t]);
      for (std::size_t i = 0; i < size; ++i) {
        for (int c = 0; c < 3; ++c) light.radiance[t][c] += float(y[i] * double(bands[c][i]));
        basis.push_back(float(y[i]) * light.solid_angle[t]);
      }
    }
  }
};

/// Coefficients of what the open texels show.
std::vector<double> project_open(const Texels& texels, const BitCube& blocked, std::size_t size) {
  std::vector<float> sum(size, 0.0f);
  for (int t = 0; t < texels.light.size(); ++t)
    if (!blocked.test(t))
      for (std::size_t i = 0; i < size; ++i) sum[i] += texels.basis[std::size_t(t) * size + i];
  return {sum.begin(), sum.end()};
}

}  // namespace

std::vector<Approximation> attribute(int order, const Receivers& receivers, const SphereSet& spheres,
                                     const std::array<std::vector<float>, 3>& bands) {
  const Texels texels(order, bands);
  const auto size = std::size_t(sh::coefficients(order));
  RayScene rays;
  rays.build(spheres);
  const sh::Tensor& tensor = sh::tensor(order);
  const auto count = std::size_t(receivers.size());
  Approximation light{"light", std::vector<vec3>(count, vec3(0.0f))}, visibility = light;
  visibility.name = "visibility";
  tbb::parallel_for(0, receivers.size(), [&](int i) {
    if (!receivers.valid(i)) return;
    const vec3 normal = receivers.normal[i];
    BitCube blocked(texel_edge);
    if (!receivers.on_occluder[i])
      trace_texels(rays, receivers.ray_origin(i), normal, texels.light.directions, true, blocked);
    light.radiance[i] = pixel_sum(texels.light, blocked, normal, receivers.albedo[i]);
    const std::vector<double> v = project_open(texels, blocked, size),
                              lobe = sh::rotate_zonal(sh::cosine_lobe(order), normal),
                              reflected = tensor.product(v, lobe);
    for (int c = 0; c < 3; ++c) {
      double sum = 0.0;
      for (std::size_t k = 0; k < size; ++k) sum += double(bands[c][k]) * reflected[k];
      visibility.radiance[i][c] = receivers.albedo[i][c] * float(sum / pi);
    }
  });
  return {std::move(light), std::move(visibility), {"exponential", {}}};
}

}  // namespace penumbra::sh_exponentiation
