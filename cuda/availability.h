// Can CUDA run here, and if not, why: told in a few words that listings and skipped rows show.
#pragma once

#include <string>

namespace penumbra {

/// What the driver said when it was asked.
struct CudaProbe {
  int driver = 0, runtime = 0;  ///< CUDA versions, 1000 major + 10 minor; driver 0: there is none
  std::string error;            ///< CUDA's text, if devices could not be counted
  int devices = 0;
  std::string name;    ///< of the first
  int capability = 0;  ///< 10 major + minor
  int least = 0;       ///< capability that the kernels are built for, at least
};

/// Why kernels cannot run, in a few words; empty if they can.
inline std::string why_unavailable(const CudaProbe& p) {
  const auto version = [](int v) { return std::to_string(v / 1000) + "." + std::to_string(v % 1000 / 10); };
  const auto capability = [](int c) { return std::to_string(c / 10) + "." + std::to_string(c % 10); };
  if (p.driver == 0) return "no CUDA device (no driver is installed)";
  if (p.driver / 1000 < p.runtime / 1000)
    return "the driver is too old: it knows CUDA " + version(p.driver) + ", this build needs " + version(p.runtime);
  if (p.devices == 0) return "no CUDA device" + (p.error.empty() ? "" : " (" + p.error + ")");
  if (!p.error.empty()) return "CUDA failed: " + p.error;
  if (p.capability < p.least)
    return "the device is too old: " + p.name + " has compute capability " + capability(p.capability) +
           ", this build needs " + capability(p.least);
  return "";
}

}  // namespace penumbra
