#include "harness/report/comparison_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>

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
  if (!has_ratio(time)) return "";
  return time.ratio < 1000.0 ? fmt::format("{:.3f}x", time.ratio) : ">999x";
}

/// "1.021-1.047".
std::string interval_text(const TimeComparison& time) {
  if (!has_ratio(time) || !std::isfinite(time.interval.high)) return "";
  return fmt::format("{:.3f}-{:.3f}", time.interval.low, time.interval.high);
}

std::string percent(const std::optional<double>& relative) {
  return relative ? three_digits(100.0 * *relative) : "black";
}

/// "0.512 -> 0.733 %" of truth, or "of cube"; "" if the error is the same.
std::string error_text(const ErrorComparison& error) {
  if (error.verdict == Error::none || error.verdict == Error::same || error.verdict == Error::unknown) return "";
  return fmt::format("{} -> {} %", percent(error.base), percent(error.next)) +
         (error.rung == "truth" ? "" : " of " + printable(error.rung));
}

/// Why there is no verdict; "" if there is one.
std::string why(const ComparedRow& row) {
  if (!row.broken.empty()) return row.broken;
  return row.time.why.empty() || row.error.verdict == Error::unknown ? row.error.why : row.time.why;
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
  add([](const ComparedRow& r) { return r.unknown(); }, "unknown");
  add([](const ComparedRow& r) { return r.perhaps_faster() && !r.unknown(); }, "perhaps faster");
  add([](const ComparedRow& r) { return r.time.verdict == Time::not_comparable; }, "without comparable times");
  add([](const ComparedRow& r) { return !r.changed() && r.time.verdict != Time::not_comparable; }, "same");
  if (comparison.unmeasured > 0) parts.push_back(count_text(comparison.unmeasured, "measured in neither"));
  if (!comparison.removed.empty()) parts.push_back(count_text(comparison.removed.size(), "removed"));
  if (!comparison.added.empty()) parts.push_back(count_text(comparison.added.size(), "added"));
  return parts;
}

/// "removed: a", a name a line, as many as there is room for.
void add_names(const char* what, const std::vector<std::string>& names, std::size_t room, int width,
               std::string& text) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k + 1 >= room && k + 1 < names.size()) {
      text += fmt::format("{}: {} more (--json lists all)\n", what, names.size() - k);
      return;
    }
    text += cut_in_middle(fmt::format("{}: {}", what, printable(names[k])), width) + "\n";
  }
}

std::vector<const Row*> new_rows(const Comparison& comparison) {
  std::vector<const Row*> rows;
  for (const ComparedRow& row : comparison.rows) rows.push_back(row.next);
  return rows;
}

/// "bunny-city: pixel-basis visibility=raster".
std::string short_name(const ComparedRow& row, const std::vector<const Row*>& rows) {
  return printable(row.next->id.scene + ": " + short_label(*row.next, rows));
}

/// Why rows have no verdict, each reason once, with how many it holds for and the first of them.
std::vector<std::string> reasons(const Comparison& comparison) {
  std::map<std::string, std::pair<std::size_t, std::string>> found;
  const std::vector<const Row*> all = new_rows(comparison);
  for (const ComparedRow& row : comparison.rows) {
    const bool different = row.time.verdict == Time::not_comparable;
    if (!row.broken.empty() || (!different && row.time.verdict != Time::unknown && row.error.verdict != Error::unknown))
      continue;
    auto& [count, first] = found[std::string(different ? "not comparable: " : "unknown: ") + why(row)];
    if (count++ == 0) first = short_name(row, all);
  }
  std::vector<std::string> lines;
  lines.reserve(found.size());
  for (const auto& [reason, rows] : found)
    lines.push_back(reason + (rows.first == 1 ? " (" + rows.second + ")" : fmt::format(" ({} rows)", rows.first)));
  return lines;
}

/// Reasons and notes as lines of a screen, at most so many.
std::vector<std::string> remarks(const Comparison& comparison, int width, std::size_t most) {
  std::vector<std::string> lines;
  std::vector<std::string> texts = reasons(comparison);
  texts.insert(texts.end(), comparison.notes.begin(), comparison.notes.end());
  for (const std::string& text : texts) {
    std::istringstream all(wrapped(printable(text), width, 2));
    for (std::string line; std::getline(all, line);) lines.push_back(cut_to_columns(line, width));
  }
  if (lines.size() <= most) return lines;
  lines.resize(most - 1);
  lines.emplace_back("... (--json tells all)");
  return lines;
}

/// What a change says beside its time.
std::string told(const ComparedRow& row) {
  if (!row.broken.empty()) return printable(row.broken);
  return row.error.verdict == Error::none || row.error.verdict == Error::same
             ? ""
             : word_of(row.error) + " " + error_text(row.error);
}

/// What comes from files in the middle of Markdown, without a meaning there.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : printable(text)) {
    const bool marked = std::string_view("\\`*_[]#~").find(c) != std::string_view::npos;
    if (c == '<' || c == '>' || c == '&' || c == '@') out += fmt::format("&#{};", int(c));  // no tag, nobody is called
    else out += (marked ? "\\" : "") + std::string(1, c);
  }
  return out;
}

/// As code.
std::string code(const std::string& name) {
  std::string text = printable(name);
  std::replace(text.begin(), text.end(), '`', '\'');
  return "`" + text + "`";
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
  constexpr std::size_t most_lines = 20, most_remarks = 8;
  const bool narrow = width < 70;
  std::string text = wrapped(comparison_verdict(comparison), width, 2) + "\n";
  const std::vector<std::string> tail = remarks(comparison, width, most_remarks);
  TextTable table({{"row", narrow ? std::max(12, width - 34) : width - (width < 95 ? 42 : 56), Align::left},
                   {"time", narrow ? 7 : 14, Align::left},
                   {"ratio", 7, Align::right},
                   {"95 %", width < 95 ? 0 : 11, Align::left},
                   {"error", 60, Align::left}},
                  width);
  const auto head = std::size_t(std::count(text.begin(), text.end(), '\n'));
  const auto gone = std::size_t(!comparison.removed.empty()) + std::size_t(!comparison.added.empty());
  const std::size_t room = most_lines - head - 2 - tail.size() - gone;  // but for titles and what is left out
  const std::vector<const Row*> rows = new_rows(comparison);
  std::size_t shown = 0, changed = 0;
  for (const ComparedRow& row : comparison.rows) {
    if (!row.changed() || ++changed > room) continue;
    const int name = narrow ? std::max(12, width - 34) : width - (width < 95 ? 42 : 56);
    table.row({cut_in_middle(short_name(row, rows), name), row.broken.empty() ? word_of(row.time) : "",
               ratio_text(row.time), interval_text(row.time), told(row)});
    ++shown;
  }
  if (shown > 0) text += table.text();
  if (changed > shown) text += fmt::format("  ... and {} more (--json lists all)\n", changed - shown);
  const std::size_t left = room + gone - shown;
  add_names("removed", comparison.removed, comparison.added.empty() ? left : std::max<std::size_t>(1, left / 2), width,
            text);
  add_names("added", comparison.added, comparison.removed.empty() ? left : std::max<std::size_t>(1, left / 2), width,
            text);
  for (const std::string& line : tail) text += line + "\n";
  return text;
}

std::string make_comparison_markdown(const Comparison& comparison) {
  const std::vector<std::string> columns = {"row", "base ms", "new ms", "ratio", "95 %", "time", "error", ""};
  MarkdownTable changed(columns), different(columns), same(columns);
  std::size_t counts[2] = {};
  for (const ComparedRow& row : comparison.rows) {
    const auto ms = [](double value) { return value > 0.0 ? three_digits(value) : ""; };
    const std::string error =
        row.error.verdict == Error::same ? "same" : word_of(row.error) + " " + error_text(row.error);
    const bool differs = row.time.verdict == Time::not_comparable;
    if (!row.changed()) ++counts[int(differs)];
    (row.changed() ? changed
     : differs     ? different
                   : same)
        .add({code(row.name), ms(row.time.base_ms), ms(row.time.next_ms), ratio_text(row.time), interval_text(row.time),
              word_of(row.time), error, plain(why(row))});
  }
  std::string text = "### penumbra: " + comparison_verdict(comparison) + "\n\n" + changed.text();
  for (const std::string& note : comparison.notes) text += "\n" + plain(note) + "\n";
  const auto list = [&](const char* what, const std::vector<std::string>& names) {
    if (names.empty()) return;
    text += fmt::format("\n{}:\n\n", what);
    for (const std::string& name : names) text += "- " + code(name) + "\n";
  };
  list("Removed", comparison.removed);
  list("Added", comparison.added);
  const auto fold = [&](std::size_t count, const char* what, const MarkdownTable& table) {
    if (count > 0)
      text += fmt::format("\n<details><summary>{} {}</summary>\n\n{}\n</details>\n", count_text(count, "row", "rows"),
                          what, table.text());
  };
  fold(counts[1], "whose times cannot be compared", different);
  fold(counts[0], "without a change", same);
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
