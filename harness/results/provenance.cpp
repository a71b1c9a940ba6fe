#include "harness/results/provenance.h"

#include <fmt/format.h>

namespace penumbra {
namespace {

std::string value(const nlohmann::json& context, const char* field) {
  if (!context.contains(field)) return "none";
  const nlohmann::json& at = context.at(field);
  const std::string text = at.is_string() ? at.get<std::string>() : at.dump();
  return text.size() == 40 ? text.substr(0, 10) : text;  // a digest
}

}  // namespace

std::string difference_of(const std::vector<const char*>& fields, const nlohmann::json& then,
                          const nlohmann::json& now) {
  std::string text;
  for (const char* field : fields)
    if (const auto missing = nlohmann::json(); then.value(field, missing) != now.value(field, missing))
      text +=
          fmt::format("{}{} {} then, {} now", text.empty() ? "" : "; ", field, value(then, field), value(now, field));
  return text;
}

std::string difference(const nlohmann::json& then, const nlohmann::json& now) {
  return difference_of({"suite", "commit", "dirty", "program", "cpu_name", "num_cpus", "instruction_sets", "compiler",
                        "flags", "build_type", "cuda", "cuda_device", "cuda_capability", "cuda_driver", "cuda_runtime"},
                       then, now);
}

}  // namespace penumbra
