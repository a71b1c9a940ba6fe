#include "harness/report/score_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "harness/report/row_text.h"

namespace penumbra {
namespace {

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

/// Columns after the first.
std::string figures(const Errors& e) {
  if (e.receivers == 0) return fmt::format("{:>10}{:>11}", 0, "-");
  return fmt::format("{:>10}{:>11}{:>11.4g}{:>11.4g}{:>+11.3g}{:>9}{:>8}{:>8}", e.receivers, percent_text(e.rel_rmse),
                     e.rmse, e.max, e.mean_signed, number(e.psnr, 1), number(e.ssim, 4), number(e.flip, 4));
}

std::string line(const std::string& what, const Errors& e) {
  return fmt::format("  {:<10}{}\n", what, figures(e));
}

double truth_rmse(const Row& row) {
  const auto at = row.score.errors.find("truth");
  return at == row.score.errors.end() ? std::numeric_limits<double>::infinity() : at->second.report.all.rmse;
}

std::string place_of(const Row& row, const std::vector<Row>& rows) {
  std::vector<const Row*> sorted = good_rows(rows, row.id.scene);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Row* a, const Row* b) { return truth_rmse(*a) < truth_rmse(*b); });
  const auto own =
      std::find_if(sorted.begin(), sorted.end(), [&](const Row* other) { return other->id.name() == row.id.name(); });
  const std::ptrdiff_t place = own - sorted.begin(), count = std::ssize(sorted), most = 10;
  if (count < 2) return "";
  const std::ptrdiff_t first =
      std::clamp(place - most / 2, std::ptrdiff_t(0), std::max(count - most, std::ptrdiff_t(0)));
  std::string text = fmt::format("Number {} of {} rows of this scene by error against truth:\n", place + 1, count);
  for (std::ptrdiff_t k = first; k < std::min(count, first + most); ++k) {
    const Row& r = *sorted[std::size_t(k)];
    const std::string parameters = telling_parameters(r, sorted);
    const std::string what = r.id.technique + " " + r.id.backend + (parameters.empty() ? "" : " " + parameters);
    text += fmt::format("{} {:>20} %{:>12}  {:.55}\n", k == place ? ">" : " ", rung_or_tie(r, "truth"),
                        r.timing.timed() ? fmt::format("{:.3f} ms", r.timing.median_frame_ms()) : "no time", what);
  }
  return text;
}

}  // namespace

std::string make_score_text(const Row& row, const std::vector<Row>& rows) {
  std::string text = fmt::format("  {:<10}{:>10}{:>11}{:>11}{:>11}{:>11}{:>9}{:>8}{:>8}\n", "against", "receivers",
                                 "rel.RMSE %", "RMSE", "max", "signed", "PSNR", "SSIM", "FLIP");
  const auto truth = row.score.errors.find("truth");
  if (truth != row.score.errors.end()) text += line("truth", truth->second.report.all);
  for (const auto& [rung, errors] : row.score.errors)
    if (rung != "truth") text += line(rung, errors.report.all);
  if (truth == row.score.errors.end()) return text + place_of(row, rows);
  for (std::size_t k = 0; k < region_names.size(); ++k) text += line(region_names[k], truth->second.report.region[k]);
  text += fmt::format("The truth's noise is {} %{}; umbra, penumbra and lit are regions of the truth.\n",
                      percent_text(truth->second.rel_noise),
                      truth->second.tie() ? ", and the image errs no more than that (a tie)" : "");
  return text + place_of(row, rows);
}

}  // namespace penumbra
