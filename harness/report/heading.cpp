#include <fmt/format.h>

#include <algorithm>

#include "harness/report/tables.h"

namespace penumbra {
namespace {

/// A field of the context as text; "" if it is not there.
std::string text_of(const nlohmann::json& context, const char* field) {
  const auto at = context.find(field);
  if (at == context.end() || at->is_null()) return "";
  return at->is_string() ? at->get<std::string>() : at->dump();
}

/// "9 repetitions", or "3 to 9 repetitions" where a resumed run kept rows of another.
std::string repetitions_text(const std::vector<Row>& rows) {
  std::size_t least = 0, most = 0;
  for (const Row& row : rows) {
    if (!row.ok()) continue;
    const std::size_t count = row.timing.frame_ms.size();
    least = most ? std::min(least, count) : count, most = std::max(most, count);
  }
  if (most == 0) return "nothing was measured";
  const char* noun = most == 1 ? "repetition" : "repetitions";
  return least == most ? fmt::format("{} {}", most, noun) : fmt::format("{} to {} {}", least, most, noun);
}

std::string machine_text(const nlohmann::json& context) {
  std::string text = text_of(context, "cpu_name");
  if (const std::string cores = text_of(context, "num_cpus"); !cores.empty()) text += ", " + cores + " cores";
  if (const std::string device = text_of(context, "cuda_device"); !device.empty()) text += "; " + device;
  if (context.value("busy", false)) text += "; it was busy: times are those of a machine that had other work";
  return text;
}

std::string program_text(const nlohmann::json& context) {
  std::string text = text_of(context, "commit").substr(0, 10);
  if (text_of(context, "dirty") == "true") text += " with changes that are not committed";
  for (const char* field : {"compiler", "build_type"})
    if (const std::string value = text_of(context, field); !value.empty()) text += ", " + value;
  return text;
}

}  // namespace

std::string make_heading(const nlohmann::json& context, const std::vector<Row>& rows) {
  const std::string suite = text_of(context, "suite");
  std::string text = fmt::format("# {}\n\n", suite.empty() ? "penumbra" : suite);
  const std::pair<const char*, std::string> lines[] = {{"machine", machine_text(context)},
                                                       {"date", text_of(context, "date")},
                                                       {"commit", program_text(context)},
                                                       {"measured", repetitions_text(rows)}};
  for (const auto& [name, value] : lines)
    if (!value.empty()) text += fmt::format("- {}: {}\n", name, value);
  return text;
}

}  // namespace penumbra
