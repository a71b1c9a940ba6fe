// Go's benchmark format (golang.org/design/14313-benchmark-format), which benchstat compares: a line a repetition.
#include <fmt/format.h>

#include <algorithm>

#include "harness/report/formats/exported_rows.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

/// A name has no spaces, and the parts that benchstat can filter by read key=value. A space becomes what no two names
/// of scenes of a suite differ by.
std::string name_of(const Row& row) {
  std::string name = row.id.name();
  for (char& letter : name) {
    if (letter == ':') letter = '=';
    if (static_cast<unsigned char>(letter) <= ' ') letter = '-';
  }
  return "BenchmarkPenumbra/" + name;
}

/// "key: value", above the lines that it holds for.
std::string settings_of(const nlohmann::json& context) {
  std::string text;
  for (const char* field : {"suite", "commit", "cpu_name", "compiler", "flags"}) {
    const std::string value = printable(context_text(context, field));
    if (!value.empty()) text += fmt::format("{}: {}\n", field == std::string("cpu_name") ? "cpu" : field, value);
  }
  return text;
}

}  // namespace

Exported export_benchstat(const std::vector<Results>& runs) {
  std::string text = settings_of(runs.front().context) + "Unit error assume=exact\nUnit B assume=exact\n\n";
  for (const Row* row : measured_rows(runs.front().rows)) {
    std::string others;
    if (const auto error = row->score.truth_error()) others += fmt::format(" {} error", *error);
    if (!row->id.external()) others += fmt::format(" {} B", row->facts.bytes.total());
    const long count = std::max(1L, row->timing.iterations);
    for (const double ms : row->timing.frame_ms)
      text += fmt::format("{} {} {} ns/op{}\n", name_of(*row), count, 1e6 * ms, others);
    if (!row->timing.timed() && !others.empty()) text += fmt::format("{} {}{}\n", name_of(*row), count, others);
  }
  return {text, unmeasured_text(runs.front().rows)};
}

}  // namespace penumbra
