// Times every kernel on the device, by events of its own.
// usage: kernel_times OUT.json [repetitions, default 20]
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "cuda/register_cuda.h"
#include "cuda/runtime.h"
#include "cuda/workloads.h"
#include "techniques/all.h"

namespace {

using namespace penumbra;

/// The device's peaks, from what it says of itself: GB/s of memory, TFLOP/s of single precision with a multiply-add as
/// two operations.
nlohmann::json peaks() {
  const auto attribute = [](cudaDeviceAttr which) {
    int value = 0;
    cuda::check(cudaDeviceGetAttribute(&value, which, 0), "cudaDeviceGetAttribute");
    return double(value);
  };
  const double major = attribute(cudaDevAttrComputeCapabilityMajor),
               minor = attribute(cudaDevAttrComputeCapabilityMinor);
  const double lanes = major == 7 || (major == 8 && minor == 0) ? 64 : 128;  // of a multiprocessor
  const double multiprocessors = attribute(cudaDevAttrMultiProcessorCount);
  return {{"gbs", 2e-6 * attribute(cudaDevAttrMemoryClockRate) * attribute(cudaDevAttrGlobalMemoryBusWidth) / 8},
          {"tflops", 2e-9 * multiprocessors * lanes * attribute(cudaDevAttrClockRate)}};
}

/// Medians over frames of the sum of a kernel's launches, ms.
std::map<std::string, std::vector<double>> time_kernels(Technique& technique, const Scene& scene, int repetitions) {
  std::vector<vec3> image(std::size_t(scene.receivers.size()));
  std::map<std::string, std::vector<double>> samples;
  for (int frame = -3; frame < repetitions; ++frame) {  // three to warm up
    cuda::profile_kernels(true);
    technique.update({0.0, scene.mesh, scene.spheres, scene.light, scene.receivers, {false, true, true, true}});
    technique.shade({image.data(), scene.receivers.width, scene.receivers.height});
    for (const auto& [name, time] : cuda::kernel_times())
      if (frame >= 0) samples[name].push_back(time.ms);
    cuda::profile_kernels(false);
  }
  return samples;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: kernel_times OUT.json [repetitions]\n");
    return 2;
  }
  const int repetitions = argc > 2 ? std::atoi(argv[2]) : 20;
  Registry registry;
  register_techniques(registry);
  register_cuda(registry);
  const BackendState& device = registry.states().at(Backend::cuda);
  if (!device.available()) {
    std::fprintf(stderr, "kernel_times: %s\n", device.status.c_str());
    return 2;
  }
  nlohmann::json rows = nlohmann::json::array();
  for_each_workload(registry, 1024, [&](const Entry& entry, const Parameters& parameters, const Scene& scene) {
    const auto technique = make_technique(entry, parameters);
    technique->prepare(scene);
    for (auto& [name, samples] : time_kernels(*technique, scene, repetitions)) {
      std::nth_element(samples.begin(), samples.begin() + std::ptrdiff_t(samples.size() / 2), samples.end());
      nlohmann::json row = report_row(entry, parameters, scene);
      row["kernel"] = readable_kernel(name, parameters);
      row["ms"] = samples[samples.size() / 2];
      rows.push_back(row);
    }
  });
  const nlohmann::json out = {{"context", device.context()}, {"peaks", peaks()}, {"kernels", rows}};
  std::ofstream(argv[1]) << out.dump(1) << "\n";
}
