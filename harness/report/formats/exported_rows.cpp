#include "harness/report/formats/exported_rows.h"

#include <fmt/format.h>

namespace penumbra {

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats = {
      {"csv", "every row and every field, for spreadsheets and pandas", false, export_csv},
      {"latex", "a table for a paper (package booktabs)", false, export_latex},
      {"bmf", "Bencher Metric Format", false, export_bmf},
      {"github", "github-action-benchmark, tool customSmallerIsBetter", false, export_github},
      {"benchstat", "Go's benchmark format, a line a repetition", false, export_benchstat},
      {"lnt", "a test report of LLVM's LNT", false, export_lnt},
      {"otava", "a CSV of Apache Otava, a line a run", true, export_otava}};
  return formats;
}

std::vector<const Row*> measured_rows(const std::vector<Row>& rows) {
  std::vector<const Row*> measured;
  for (const Row& row : rows)
    if (row.ok()) measured.push_back(&row);
  return measured;
}

std::string unmeasured_text(const std::vector<Row>& rows) {
  const std::size_t missing = rows.size() - measured_rows(rows).size();
  return missing == 0 ? "" : fmt::format("{} of {} rows are failed or skipped", missing, rows.size());
}

std::string context_text(const nlohmann::json& context, const char* field) {
  const auto at = context.find(field);
  if (at == context.end()) return "";
  return at->is_string() ? at->get<std::string>() : at->dump();
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t k = 0; k < cells.size(); ++k) line += (k ? "," : "") + csv_cell(cells[k]);
  return line + "\r\n";
}

std::string json_text(const nlohmann::json& document) {
  return document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace penumbra
