// A table for a paper: rows of every scene by frame time.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "harness/report/formats/exported_rows.h"
#include "harness/report/row_text.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    if (std::string_view("&%$#_{}").find(letter) != std::string_view::npos) out += std::string("\\") + letter;
    else if (letter == '~') out += "\\textasciitilde{}";
    else if (letter == '^') out += "\\textasciicircum{}";
    else if (letter == '\\') out += "\\textbackslash{}";
    else if (static_cast<unsigned char>(letter) >= ' ') out += letter;
  }
  return out;
}

std::string dash_if_empty(const std::string& text) {
  return text.empty() ? "--" : text;
}

std::string error_text(const Row& row) {
  const std::optional<double> error = row.score.truth_error();
  return error ? three_digits(100.0 * *error) : "--";
}

std::string line_of(const Row& row, const std::vector<const Row*>& rows) {
  const std::string ms = row.timing.timed() ? three_digits(row.timing.median_frame_ms()) : "--";
  const std::vector<std::string> cells = {escaped(row.id.scene),
                                          escaped(row.id.technique),
                                          escaped(row.id.backend),
                                          escaped(telling_parameters(row, rows)),
                                          dash_if_empty(threads_text(row.id)),
                                          ms,
                                          error_text(row),
                                          dash_if_empty(mebibytes_text(row))};
  return fmt::format("{} \\\\\n", fmt::join(cells, " & "));
}

/// Rows without a time stand last.
bool sooner(const Row* a, const Row* b) {
  const double first = a->timing.median_frame_ms(), second = b->timing.median_frame_ms();
  return !std::isnan(first) && (std::isnan(second) || first < second);
}

}  // namespace

Exported export_latex(const std::vector<Results>& runs) {
  const std::vector<Row>& all = runs.front().rows;
  std::string text =
      "% \\usepackage{booktabs}\n\\begin{tabular}{llllrrrr}\n\\toprule\n"
      "scene & technique & backend & parameters & threads & ms & error \\% & MiB \\\\\n";
  for (const std::string& scene : scenes_of(all)) {
    std::vector<const Row*> rows = good_rows(all, scene);
    if (rows.empty()) continue;
    std::stable_sort(rows.begin(), rows.end(), sooner);
    text += "\\midrule\n";
    for (const Row* row : rows) text += line_of(*row, rows);
  }
  return {text + "\\bottomrule\n\\end{tabular}\n", unmeasured_text(all)};
}

}  // namespace penumbra
