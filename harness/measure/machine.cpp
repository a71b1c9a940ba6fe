#include "harness/measure/machine.h"

#include <hwy/targets.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include "scenes/assets.h"
#include "scenes/storage/content_key.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>/dev/null").c_str(), "r"), pclose);
  std::string text;
  std::array<char, 256> buffer;
  while (pipe && fgets(buffer.data(), int(buffer.size()), pipe.get())) text += buffer.data();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// SHA-1 of the running program: two builds of one commit are not the same if their sources or flags were not.
std::string program_digest() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  ContentHash hash;
  std::vector<char> block(1 << 20);
  while (file.read(block.data(), std::streamsize(block.size())) || file.gcount() > 0)
    hash.add(std::string_view(block.data(), std::size_t(file.gcount())));
  return hash.digest();
}

/// Those of this processor that kernels were compiled for.
std::string instruction_sets() {
  std::string names;
  for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    if (!names.empty()) names += ' ';
    names += hwy::TargetName(left & -left);
  }
  return names;
}

}  // namespace

std::map<std::string, std::string> describe_machine(const Registry& registry) {
  const std::string git = "git -C '" + data_folder() + "' ";
  // An installation may lie in a repository of something else.
  const bool ours = !output_of(git + "ls-files assets.toml").empty();
  const std::string commit = ours ? output_of(git + "rev-parse HEAD") : "";
  std::map<std::string, std::string> machine;
  for (const auto& [backend, state] : registry.states()) {
    machine[to_string(backend)] = state.status;
    if (state.available()) machine.merge(state.context());
  }
  machine.insert({{"cpu_name", cpu_name()},
                  {"instruction_sets", instruction_sets()},
                  {"compiler", PENUMBRA_COMPILER},
                  {"flags", PENUMBRA_FLAGS},
                  {"build_type", PENUMBRA_BUILD_TYPE},
                  {"program", program_digest()},
                  {"commit", commit.empty() ? "unknown" : commit},
                  {"dirty", !ours || output_of(git + "status --porcelain").empty() ? "false" : "true"}});
  return machine;
}

}  // namespace penumbra
