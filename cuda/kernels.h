// The techniques that have kernels: one line each, with the name that the registry knows and what makes it.
#pragma once

#include <memory>

#include "techniques/registry.h"

#define PENUMBRA_CUDA_TECHNIQUES(USE)              \
  USE("pixel-basis", make_pixel_basis)             \
  USE("wavelet", make_wavelet)                     \
  USE("wavelet-product", make_wavelet_product)     \
  USE("wavelet-dense", make_wavelet_dense)         \
  USE("sh-lighting", make_sh_lighting)             \
  USE("sh-exponentiation", make_sh_exponentiation) \
  USE("pcss", make_pcss)                           \
  USE("hqepcss", make_hqepcss)                     \
  USE("fast-pcss", make_fast_pcss)

namespace penumbra {

#define PENUMBRA_DECLARE(name, make) std::unique_ptr<Technique> make(const Parameters& parameters);
namespace cuda {  // on the device
PENUMBRA_CUDA_TECHNIQUES(PENUMBRA_DECLARE)
}
namespace cuda_on_host {  // executed on the host, in tests
PENUMBRA_CUDA_TECHNIQUES(PENUMBRA_DECLARE)
}
#undef PENUMBRA_DECLARE

using Maker = std::function<std::unique_ptr<Technique>(const Parameters&)>;

/// Parameters that only the device has.
inline std::vector<Parameter> device_parameters(const std::string& name) {
  if (!name.starts_with("wavelet")) return {};
  return {choice_parameter("kernels", {"fused", "separate"},
                           "one kernel, or the paper's three: merge spheres, transform, multiply")};
}

/// The entry of a technique's kernels: its scalar twin's but for the backend and device_parameters().
inline Entry cuda_entry(const Registry& registry, const std::string& name, Maker make, const std::string& unavailable) {
  Entry entry = registry.find(name, "scalar");
  for (Parameter& p : device_parameters(name)) entry.parameters.push_back(std::move(p));
  entry.backend = "cuda";
  entry.make = std::move(make);
  entry.unavailable = unavailable;
  return entry;
}

}  // namespace penumbra
