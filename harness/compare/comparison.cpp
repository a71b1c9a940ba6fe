#include "harness/compare/comparison.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "harness/results/provenance.h"
#include "harness/results/statistics.h"

namespace penumbra {
namespace {

using Time = TimeComparison::Verdict;
using Error = ErrorComparison::Verdict;
using Names = std::set<std::string>;

/// Names of parameters by technique and backend.
std::map<std::string, Names> known_parameters(const std::vector<Row>& rows) {
  std::map<std::string, Names> known;
  for (const Row& row : rows)
    for (const auto& [name, value] : row.id.parameters) known[row.id.technique + "/" + row.id.backend].insert(name);
  return known;
}

/// What a row is, in terms of parameters that the other run knows; of others, those that are not at their default.
std::string identity(const Row& row, const std::map<std::string, Names>& others) {
  const RowIdentity& id = row.id;
  std::string text =
      fmt::format("{}/{}/{}/{}/{}/{}", id.scene, id.spheres, id.objective, id.technique, id.backend, id.threads);
  const auto known = others.find(id.technique + "/" + id.backend);
  for (const auto& [name, value] : id.parameters) {
    const auto fallback = id.defaults.find(name);
    const bool usual = fallback != id.defaults.end() && fallback->second == value;
    if (!usual || (known != others.end() && known->second.contains(name)))
      text += fmt::format("/{}:{}", name, to_string(value));
  }
  return text;
}

using Found = std::map<std::string, std::vector<const Row*>>;

Found by_identity(const std::vector<Row>& rows, const std::vector<Row>& others) {
  const auto known = known_parameters(others);
  Found found;
  for (const Row& row : rows) found[identity(row, known)].push_back(&row);
  return found;
}

/// What reading a file makes of times that are none.
bool unusable(const Row& row) {
  return row.status.find("its times cannot be used") != std::string::npos;
}

/// What became of a row that not both have measured; empty if both have.
std::string broken(const Row& base, const Row& next) {
  if (base.ok() && next.ok()) return "";
  const std::size_t colon = std::min(next.status.find(':'), next.status.size());
  if (base.ok()) return (next.failed() ? "failed now" : "skipped now") + next.status.substr(colon);
  return next.ok() ? "mended" : "";
}

bool measured_in_neither(const Row& base, const Row& next) {
  return !base.ok() && !next.ok() && !unusable(base) && !unusable(next);
}

ComparedRow compared(const Row& base, const Row& next, const std::string& not_comparable, int looks,
                     const Thresholds& thresholds) {
  ComparedRow row{next.id.name(), &base, &next, {}, {}, broken(base, next)};
  for (const auto& [whose, side] : {std::pair("base", &base), {"new", &next}})
    if (unusable(*side)) {
      row.broken.clear();
      row.error = compare_errors(base, next, thresholds);
      row.time.verdict = Time::unknown, row.time.why = fmt::format("{} {}", whose, side->status);
      return row;
    }
  if (!base.ok() || !next.ok()) return row;
  row.error = compare_errors(base, next, thresholds);
  row.time = measure_change(base.timing, next.timing, looks);
  if (row.time.verdict == Time::none || !row.time.why.empty()) return row;
  std::string why = looks > 0 ? "" : not_comparable;
  const auto differ = [&](const char* what, const std::string& then, const std::string& now) {
    if (why.empty() && then != now) why = fmt::format("{} differs", what);
  };
  differ("the scene's content or its truth", base.facts.scene_key, next.facts.scene_key);
  differ("the instruction set", base.facts.instruction_set, next.facts.instruction_set);
  if (!why.empty()) row.time.verdict = Time::not_comparable, row.time.why = why;
  return row;
}

bool measured(const ComparedRow& row) {
  return row.time.verdict == Time::unknown && row.time.why.empty();
}

/// Between separate runs: how much rows scatter beyond their own spread, and what that does to their probabilities.
void take_drift_in(Comparison& comparison) {
  std::vector<double> changes, errors;
  for (const ComparedRow& row : comparison.rows)
    if (measured(row)) {
      changes.push_back(std::log(row.time.ratio));
      errors.push_back(std::log(row.time.interval.high / row.time.interval.low) / (2.0 * 1.96));
    }
  const double drift = drift_between_runs(changes, errors);
  if (!(drift > 0.0005)) return;
  std::size_t k = 0;
  for (ComparedRow& row : comparison.rows)
    if (measured(row)) {
      row.time.probability = std::max(row.time.probability, drift_test(changes[k], errors[k], drift, changes.size()));
      ++k;
    }
  comparison.notes.push_back(fmt::format(
      "between these two runs rows scatter by {:.1f} % more than within them; `compare --ab` has no such scatter",
      100.0 * drift));
}

void judge_all(Comparison& comparison) {
  if (!comparison.side_by_side) take_drift_in(comparison);
  std::vector<double> probabilities;
  for (const ComparedRow& row : comparison.rows)
    if (measured(row)) probabilities.push_back(row.time.probability);
  const std::vector<double> corrected = holm(probabilities);
  std::size_t k = 0;
  for (ComparedRow& row : comparison.rows)
    if (measured(row)) {
      row.time.probability = corrected[k++];
      judge(comparison.thresholds, row.time);
    }
}

/// All rows slower by about the same is what another clock of the machine looks like, too.
void note_common_shift(Comparison& comparison) {
  std::vector<double> changes;
  for (const ComparedRow& row : comparison.rows)
    if (row.time.base_ms > 0.0 && row.time.verdict != Time::not_comparable) changes.push_back(std::log(row.time.ratio));
  if (changes.size() < 5 || comparison.side_by_side) return;
  const auto slower = std::size_t(std::count_if(changes.begin(), changes.end(), [](double c) { return c > 0.0; }));
  const double ratio = std::exp(median(changes));
  if (std::max(slower, changes.size() - slower) < changes.size() * 9 / 10 || std::abs(std::log(ratio)) < 0.01) return;
  comparison.notes.push_back(fmt::format(
      "{} of {} rows moved the same way (median {:.2f}x): a machine in another state looks the same; `compare --ab` "
      "tells them apart",
      std::max(slower, changes.size() - slower), changes.size(), ratio));
}

auto weight(const ComparedRow& row) {
  const bool worse = row.error.verdict == Error::worse, better = row.error.verdict == Error::better;
  const bool timed = row.time.verdict == Time::slower || row.time.verdict == Time::faster;
  return std::tuple(row.regressed(), row.unknown(), worse || row.time.verdict == Time::slower, better || timed,
                    row.time.verdict == Time::not_comparable,
                    std::max(std::log(row.time.ratio), worse ? std::log(row.error.factor) : 0.0));
}

void note_contexts(const nlohmann::json& base, const nlohmann::json& next, Comparison& comparison) {
  for (const auto& [whose, context] : {std::pair("base", &base), std::pair("new", &next)})
    if (const auto busy = context->find("busy"); busy != context->end() && *busy == true)
      comparison.notes.push_back(fmt::format("{}: the machine was busy", whose));
}

/// 0 unless both were measured in one session.
int looks_of(const nlohmann::json& base, const nlohmann::json& next) {
  const auto session = base.find("session"), other = next.find("session");
  if (session == base.end() || other == next.end() || !session->is_object() || *session != *other) return 0;
  const auto looks = session->find("looks");
  return looks != session->end() && looks->is_number_integer() ? looks->get<int>() : 0;
}

}  // namespace

bool ComparedRow::regressed() const {
  return time.regressed || error.regressed || broken.starts_with("failed now");
}

bool ComparedRow::perhaps_faster() const {
  return time.verdict == Time::unknown && time.base_ms > 0.0 && time.interval.high <= most_ratio;
}

bool ComparedRow::unknown() const {
  return (time.verdict == Time::unknown && !perhaps_faster()) || error.verdict == Error::unknown ||
         broken.starts_with("skipped now");
}

bool ComparedRow::changed() const {
  return regressed() || unknown() || !broken.empty() || time.verdict == Time::slower || time.verdict == Time::faster ||
         time.verdict == Time::unknown || error.verdict == Error::worse || error.verdict == Error::better;
}

int Comparison::exit_code() const {
  if (rows.empty()) return unmeasured > 0 ? 3 : 2;
  const auto any = [&](auto what) { return std::any_of(rows.begin(), rows.end(), what); };
  if (any([](const ComparedRow& row) { return row.regressed(); })) return 1;
  return !removed.empty() ||
                 any([](const ComparedRow& row) { return row.unknown() || row.time.verdict == Time::not_comparable; })
             ? 3
             : 0;
}

Comparison compare(const Results& base, const Results& next, const Thresholds& thresholds) {
  Comparison comparison;
  comparison.thresholds = thresholds;
  const int looks = looks_of(base.context, next.context);
  comparison.side_by_side = looks > 0;
  const std::string why = why_times_differ(base.context, next.context);
  if (!why.empty() && looks == 0) comparison.notes.push_back("times are not comparable: " + why);
  note_contexts(base.context, next.context, comparison);
  const Found before = by_identity(base.rows, next.rows), now = by_identity(next.rows, base.rows);
  std::vector<std::pair<const Row*, const Row*>> pairs;
  const auto unmatched = [](const std::vector<const Row*>& rows, std::vector<std::string>& names) {
    for (const Row* row : rows) names.push_back(row->id.name());
  };
  for (const auto& [identity, rows] : before) {
    const auto at = now.find(identity);
    if (at == now.end()) unmatched(rows, comparison.removed);
    else if (rows.size() > 1 || at->second.size() > 1) continue;
    else if (measured_in_neither(*rows[0], *at->second[0])) ++comparison.unmeasured;
    else pairs.emplace_back(rows[0], at->second[0]);
  }
  for (const auto& [identity, rows] : now)
    if (!before.contains(identity)) unmatched(rows, comparison.added);
  comparison.rows.resize(pairs.size());
  tbb::parallel_for(std::size_t(0), pairs.size(), [&](std::size_t k) {
    comparison.rows[k] = compared(*pairs[k].first, *pairs[k].second, why, looks, thresholds);
  });
  for (const auto& [identity, rows] : before)
    if (const auto at = now.find(identity); at != now.end() && (rows.size() > 1 || at->second.size() > 1)) {
      ComparedRow& row =
          comparison.rows.emplace_back(ComparedRow{rows[0]->id.name(), rows[0], at->second[0], {}, {}, ""});
      row.error = compare_errors(rows, at->second, thresholds);
      row.time.verdict = Time::unknown;
      row.time.why = fmt::format("stands {} times in base, {} in new", rows.size(), at->second.size());
    }
  for (ComparedRow& row : comparison.rows) row.most_ratio = 1.0 + thresholds.slower;
  judge_all(comparison);
  note_common_shift(comparison);
  std::stable_sort(comparison.rows.begin(), comparison.rows.end(),
                   [](const ComparedRow& a, const ComparedRow& b) { return weight(a) > weight(b); });
  return comparison;
}

std::string why_times_differ(const nlohmann::json& base, const nlohmann::json& next) {
  return difference_of({"cpu_name", "num_cpus", "instruction_sets", "compiler", "flags", "build_type", "cuda_device"},
                       base, next);
}

nlohmann::json session_context(const std::string& identity, int looks) {
  return {{"identity", identity}, {"looks", looks}};
}

}  // namespace penumbra
