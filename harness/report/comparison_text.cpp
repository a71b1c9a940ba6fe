#include "harness/report/comparison_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/screen.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

using Time = TimeComparison::Verdict;
using Error = ErrorComparison::Verdict;
using nlohmann::json;

// In the order of the enumerations.
constexpr const char* time_words[] = {"", "faster", "same", "slower", "unknown", "not comparable"};
constexpr const char* error_words[] = {"", "better", "same", "worse", "unknown"};

std::string word(Time verdict) {
  return time_words[int(verdict)];
}

std::string word(Error verdict) {
  return error_words[int(verdict)];
}

/// "slower", or "SLOWER" if that is a regression.
template <class Change>
std::string word_of(const Change& change) {
  std::string text = word(change.verdict);
  if (change.regressed) std::transform(text.begin(), text.end(), text.begin(), ::toupper);
  return text;
}

bool has_ratio(const TimeComparison& time) {
  return time.base_ms > 0.0 && time.verdict != Time::not_comparable;
}

/// "1.034x"; "" if there is none.
std::string ratio_text(const TimeComparison& time) {
  return has_ratio(time) ? fmt::format("{:.3f}x", time.ratio) : "";
}

/// "1.021-1.047".
std::string interval_text(const TimeComparison& time) {
  if (!has_ratio(time) || !std::isfinite(time.interval.high)) return "";
  return fmt::format("{:.3f}-{:.3f}", time.interval.low, time.interval.high);
}

std::string percent(const std::optional<double>& relative) {
  return relative ? three_digits(100.0 * *relative) : "black";
}

/// "0.512 -> 0.733 % of truth"; "" if the error is the same.
std::string error_text(const ErrorComparison& error) {
  if (error.verdict == Error::none || error.verdict == Error::same) return "";
  return fmt::format("{} -> {} % of {}", percent(error.base), percent(error.next), error.rung);
}

/// Why there is no verdict; "" if there is one.
std::string why(const ComparedRow& row) {
  if (!row.broken.empty()) return row.broken;
  return row.time.why.empty() ? row.error.why : row.time.why;
}

std::string count_text(std::size_t count, const char* what, const char* many = nullptr) {
  return fmt::format("{} {}", with_thousands(count), count == 1 || !many ? what : many);
}

template <class What>
void add_count(const Comparison& comparison, What what, const char* one, const char* many,
               std::vector<std::string>& parts) {
  const auto count = std::count_if(comparison.rows.begin(), comparison.rows.end(), what);
  if (count > 0) parts.push_back(count_text(std::size_t(count), one, many));
}

std::vector<std::string> counts(const Comparison& comparison) {
  std::vector<std::string> parts;
  const auto add = [&](auto what, const char* one, const char* many = nullptr) {
    add_count(comparison, what, one, many, parts);
  };
  add([](const ComparedRow& r) { return r.regressed(); }, "regression", "regressions");
  add([](const ComparedRow& r) { return r.time.verdict == Time::slower; }, "slower");
  add([](const ComparedRow& r) { return r.time.verdict == Time::faster; }, "faster");
  add([](const ComparedRow& r) { return r.error.verdict == Error::worse; }, "with more error");
  add([](const ComparedRow& r) { return r.error.verdict == Error::better; }, "with less error");
  add([](const ComparedRow& r) { return r.unknown() || r.time.verdict == Time::unknown; }, "unknown");
  add([](const ComparedRow& r) { return r.time.verdict == Time::not_comparable; }, "without comparable times");
  add([](const ComparedRow& r) { return !r.changed() && r.time.verdict != Time::not_comparable; }, "same");
  if (comparison.unmeasured > 0) parts.push_back(count_text(comparison.unmeasured, "measured in neither"));
  if (!comparison.removed.empty()) parts.push_back(count_text(comparison.removed.size(), "removed"));
  if (!comparison.added.empty()) parts.push_back(count_text(comparison.added.size(), "added"));
  return parts;
}

/// "removed: a, b and 3 more".
std::string names_line(const char* what, const std::vector<std::string>& names) {
  constexpr std::size_t most = 2;
  std::string text = what;
  for (std::size_t k = 0; k < std::min(most, names.size()); ++k) text += (k ? ", " : " ") + names[k];
  return names.size() > most ? text + fmt::format(" and {} more", names.size() - most) : text;
}

std::vector<const Row*> new_rows(const Comparison& comparison) {
  std::vector<const Row*> rows;
  for (const ComparedRow& row : comparison.rows) rows.push_back(row.next);
  return rows;
}

/// "bunny-city: pixel-basis visibility=raster".
std::string short_name(const ComparedRow& row, const std::vector<const Row*>& rows) {
  return row.next->id.scene + ": " + short_label(*row.next, rows);
}

json number(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json optional(const std::optional<double>& value) {
  return value ? number(*value) : json(nullptr);
}

json row_json(const ComparedRow& row) {
  json out = {{"name", row.name}, {"regressed", row.regressed()}};
  if (!row.broken.empty()) out["status"] = row.broken;
  if (row.time.verdict != Time::none)
    out["time"] = {{"verdict", word(row.time.verdict)},
                   {"base_ms", number(row.time.base_ms)},
                   {"new_ms", number(row.time.next_ms)},
                   {"ratio", number(row.time.ratio)},
                   {"interval", {number(row.time.interval.low), number(row.time.interval.high)}},
                   {"p", number(row.time.probability)},
                   {"regressed", row.time.regressed},
                   {"why", row.time.why}};
  if (row.error.verdict != Error::none)
    out["error"] = {{"verdict", word(row.error.verdict)},
                    {"rung", row.error.rung},
                    {"base", optional(row.error.base)},
                    {"new", optional(row.error.next)},
                    {"factor", number(row.error.factor)},
                    {"regressed", row.error.regressed},
                    {"why", row.error.why}};
  return out;
}

}  // namespace

std::string comparison_verdict(const Comparison& comparison) {
  static const char* words[] = {"fine", "REGRESSION", "nothing in common", "no regression found, but not all is known"};
  std::string text = words[comparison.exit_code()];
  const std::vector<std::string> parts = counts(comparison);
  for (std::size_t k = 0; k < parts.size(); ++k) text += (k ? ", " : ": ") + parts[k];
  return text;
}

std::string make_comparison_screen(const Comparison& comparison, int width) {
  constexpr std::size_t most_lines = 20;
  std::vector<std::string> tail;
  for (const std::string& note : comparison.notes) tail.push_back(cut_to_columns(note, width));
  if (!comparison.removed.empty()) tail.push_back(cut_to_columns(names_line("removed:", comparison.removed), width));
  if (!comparison.added.empty()) tail.push_back(cut_to_columns(names_line("added:", comparison.added), width));
  std::string text = wrapped(comparison_verdict(comparison), width, 2) + "\n";
  const bool narrow = width < 70;
  TextTable table({{"row", narrow ? std::max(12, width - 34) : width - 48, Align::left},
                   {"time", narrow ? 7 : 14, Align::left},
                   {"ratio", 7, Align::right},
                   {"95 %", narrow ? 0 : 11, Align::left},
                   {"error", 60, Align::left}},
                  width);
  const auto head = std::size_t(std::count(text.begin(), text.end(), '\n'));
  const std::size_t room = most_lines - head - 2 - tail.size();  // but for the columns' titles and what is left out
  const std::vector<const Row*> rows = new_rows(comparison);
  std::size_t shown = 0, changed = 0;
  for (const ComparedRow& row : comparison.rows) {
    if (!row.changed() || ++changed > room) continue;
    const std::string error = row.error.verdict == Error::none || row.error.verdict == Error::same
                                  ? why(row)
                                  : word_of(row.error) + " " + error_text(row.error);
    table.row({short_name(row, rows), row.broken.empty() ? word_of(row.time) : "", ratio_text(row.time),
               interval_text(row.time), error});
    ++shown;
  }
  if (shown > 0) text += table.text();
  if (changed > shown) text += fmt::format("  ... and {} more (--json lists all)\n", changed - shown);
  for (const std::string& line : tail) text += line + "\n";
  return text;
}

std::string make_comparison_markdown(const Comparison& comparison) {
  const std::vector<std::string> columns = {"row", "base ms", "new ms", "ratio", "95 %", "time", "error", ""};
  MarkdownTable changed(columns), others(columns);
  std::size_t same = 0;
  for (const ComparedRow& row : comparison.rows) {
    const auto ms = [](double value) { return value > 0.0 ? three_digits(value) : ""; };
    const std::string error =
        row.error.verdict == Error::same ? "same" : word_of(row.error) + " " + error_text(row.error);
    (row.changed() ? changed : others)
        .add({"`" + row.name + "`", ms(row.time.base_ms), ms(row.time.next_ms), ratio_text(row.time),
              interval_text(row.time), word_of(row.time), error, why(row)});
    same += !row.changed();
  }
  std::string text = "### penumbra: " + comparison_verdict(comparison) + "\n\n" + changed.text();
  for (const std::string& note : comparison.notes) text += "\n" + note + "\n";
  const auto list = [&](const char* what, const std::vector<std::string>& names) {
    if (names.empty()) return;
    text += fmt::format("\n{}:\n\n", what);
    for (const std::string& name : names) text += "- `" + name + "`\n";
  };
  list("Removed", comparison.removed);
  list("Added", comparison.added);
  if (same > 0)
    text += fmt::format("\n<details><summary>{} without a change</summary>\n\n{}\n</details>\n",
                        count_text(same, "row", "rows"), others.text());
  return text;
}

json comparison_json(const Comparison& comparison) {
  json out = {{"exit_code", comparison.exit_code()},
              {"verdict", comparison_verdict(comparison)},
              {"side_by_side", comparison.side_by_side},
              {"fail_slower", comparison.thresholds.slower},
              {"fail_error", comparison.thresholds.error},
              {"notes", comparison.notes},
              {"unmeasured", comparison.unmeasured},
              {"added", comparison.added},
              {"removed", comparison.removed},
              {"rows", json::array()}};
  for (const ComparedRow& row : comparison.rows) out["rows"].push_back(row_json(row));
  return out;
}

}  // namespace penumbra
