// Writing, reading and comparing results.json as a large study has it: 10,000 rows of nine repetitions, each as long as
// those of results/gpu. Run it in the repository's root: build/release/bench_large_runs
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>

#include "harness/compare/comparison.h"
#include "harness/results/results_file.h"

namespace penumbra {
namespace {

constexpr std::size_t row_count = 10'000;

Results large_results() {
  Results results = read_results_path("results/gpu/NVIDIA-H200/cuda.json");
  const std::vector<Row> rows = std::exchange(results.rows, {});
  for (std::size_t k = 0; k < row_count; ++k) {
    results.rows.push_back(rows[k % rows.size()]);
    results.rows.back().id.scene += fmt::format("-{}", k / rows.size());
  }
  return results;
}

/// A folder that is gone when the program ends.
struct Folder {
  std::string path = (std::filesystem::temp_directory_path() / fmt::format("bench-results-{}", getpid())).string();
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

const std::string& folder() {
  static const Folder kept;
  return kept.path;
}

void count(benchmark::State& state) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["file_MiB"] = double(std::filesystem::file_size(folder() + "/results.json")) / 1048576.0;
  state.counters["process_peak_MiB"] = double(usage.ru_maxrss) / 1024.0;
}

void write_large_file(benchmark::State& state) {
  const Results results = large_results();
  for (auto _ : state) write_results(folder(), results);
  count(state);
}
BENCHMARK(write_large_file)->Unit(benchmark::kMillisecond);

void read_large_file(benchmark::State& state) {
  for (auto _ : state)
    if (read_results_path(folder()).rows.size() != row_count) state.SkipWithError("rows are missing");
  count(state);
}
BENCHMARK(read_large_file)->Unit(benchmark::kMillisecond);

/// All that `penumbra compare A B` does before it prints.
void compare_large_files(benchmark::State& state) {
  for (auto _ : state)
    if (compare(read_results_path(folder()), read_results_path(folder()), {}).exit_code() != 0)
      state.SkipWithError("a run differs from itself");
  count(state);
}
BENCHMARK(compare_large_files)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace penumbra

BENCHMARK_MAIN();
