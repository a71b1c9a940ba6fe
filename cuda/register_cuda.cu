// The CUDA backend where it is built.
#include "cuda/register_cuda.h"

#include <array>
#include <cstdio>

#include "cuda/availability.h"
#include "cuda/kernels.h"
#include "cuda/runtime.h"
#include "generated/kernel_list.h"

namespace penumbra {

namespace cuda {
PENUMBRA_KERNELS(PENUMBRA_DECLARE)
}

namespace {

CudaProbe ask_driver() {
  CudaProbe probe;
  probe.least = PENUMBRA_CUDA_LEAST_CAPABILITY;
  cudaDriverGetVersion(&probe.driver);
  cudaRuntimeGetVersion(&probe.runtime);
  cudaError_t code = cudaGetDeviceCount(&probe.devices);
  cudaDeviceProp properties;
  if (code == cudaSuccess && probe.devices > 0) code = cudaGetDeviceProperties(&properties, 0);
  if (code != cudaSuccess) {
    probe.error = cudaGetErrorString(code);
    return probe;
  }
  if (probe.devices == 0) return probe;
  probe.name = properties.name;
  probe.capability = 10 * properties.major + properties.minor;
  return probe;
}

const CudaProbe& probe() {
  static const CudaProbe answer = ask_driver();
  return answer;
}

std::string version(int v) {
  return std::to_string(v / 1000) + "." + std::to_string(v % 1000 / 10);
}

/// One line of the driver's own tool; empty if it is not there.
std::string ask_tool(const std::string& query) {
  const std::string command = "nvidia-smi -i 0 --format=csv,noheader --query-gpu=" + query + " 2>/dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return "";
  std::array<char, 256> line = {};
  const bool read = fgets(line.data(), int(line.size()), pipe) != nullptr;
  pclose(pipe);
  std::string text = read ? line.data() : "";
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::map<std::string, std::string> device_context() {
  const int capability = probe().capability;
  return {{"cuda_device", probe().name},
          {"cuda_capability", std::to_string(capability / 10) + "." + std::to_string(capability % 10)},
          {"cuda_driver", version(probe().driver)},
          {"cuda_runtime", version(probe().runtime)},
          {"cuda_clocks_sm_memory", ask_tool("clocks.sm,clocks.mem")},
          {"cuda_clocks_most_sm_memory", ask_tool("clocks.max.sm,clocks.max.mem")},
          {"cuda_throttling", ask_tool("clocks_throttle_reasons.active")},
          {"cuda_temperature_power", ask_tool("temperature.gpu,power.draw")}};
}

}  // namespace

void register_cuda(Registry& registry) {
  const std::string unavailable = why_unavailable(probe());
  Makers makers;
  {
    using namespace cuda;  // NOLINT: where the files of kernels are
    PENUMBRA_KERNELS(PENUMBRA_CALL)
  }
  add_cuda_entries(registry, makers, unavailable);
  if (unavailable.empty()) registry.set_state(Backend::cuda, {"available: " + probe().name, device_context});
  else registry.set_state(Backend::cuda, {unavailable, {}});
}

}  // namespace penumbra
