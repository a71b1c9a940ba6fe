// Counts what every kernel does, by executing it on the host: operations, bytes, barriers.
// usage: kernel_counts OUT.json [edge of the square of receivers, default 64]
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include "cuda/host/execution.h"
#include "cuda/host/registry.h"
#include "cuda/workloads.h"

int main(int argc, char** argv) {
  using namespace penumbra;
  if (argc < 2) {
    fmt::print(stderr, "usage: kernel_counts OUT.json [edge of the square of receivers]\n");
    return 2;
  }
  const int edge = argc > 2 ? std::atoi(argv[2]) : 64;
  nlohmann::json rows = nlohmann::json::array();
  const Registry registry = cuda_on_host::make_registry();
  for_each_workload(registry, edge, [&](const Entry& entry, const Parameters& parameters, const Scene& scene) {
    const auto technique = make_technique(entry, parameters);
    std::vector<vec3> image(std::size_t(scene.receivers.size()));
    cuda_on_host::count_launches(true);
    technique->prepare(scene);
    technique->shade({image.data(), scene.receivers.width, scene.receivers.height});
    cuda_on_host::count_launches(false);
    for (const auto& [name, counts] : cuda_on_host::counts()) {
      nlohmann::json row = report_row(entry, parameters, scene);
      row["kernel"] = readable_kernel(name, parameters);
      row["launches"] = counts.launches, row["blocks"] = counts.blocks, row["block_size"] = counts.block_size;
      row["operations"] = counts.operations, row["bytes"] = counts.bytes;
      row["unique_bytes"] = counts.unique_bytes, row["barriers"] = counts.barriers;
      rows.push_back(row);
    }
    fmt::print(stderr, "{} {}\n", entry.name, parameters.describe());
  });
  std::ofstream(argv[1]) << rows.dump(1) << "\n";
}
