// Verdicts on two runs, of rows whose samples and errors are made up.
#include "harness/compare/comparison.h"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support.h"

namespace penumbra {
namespace {

using Time = TimeComparison::Verdict;
using Error = ErrorComparison::Verdict;

constexpr double noise = 0.002;

Row row(const std::string& scene, const std::string& technique, std::vector<double> ms, double error = 0.03) {
  Row r;
  r.id.scene = scene, r.id.technique = technique, r.id.backend = "simd", r.id.receivers = 10000;
  r.facts.scene_key = "key of " + scene;
  r.timing.frame_ms = std::move(ms);
  RungErrors truth;
  truth.report.all.receivers = 10000;
  truth.report.all.rmse = error, truth.report.all.rel_rmse = error;  // of a truth whose RMS is 1
  truth.noise = noise, truth.rel_noise = noise;
  r.score.errors["truth"] = truth;
  return r;
}

/// Samples of so many milliseconds with so much noise.
std::vector<double> samples(std::mt19937& random, double ms, double spread, int count = 9) {
  std::lognormal_distribution<double> times(0.0, spread);
  std::vector<double> all;
  for (int k = 0; k < count; ++k) all.push_back(ms * times(random));
  return all;
}

Results run(std::vector<Row> rows) {
  return {{{"cpu_name", "a CPU"}, {"num_cpus", 2}, {"flags", "-O3"}}, std::move(rows)};
}

/// So many rows, all equal but for noise.
Results run_of(int rows, std::mt19937& random, double spread, double factor = 1.0) {
  std::vector<Row> all;
  for (int k = 0; k < rows; ++k) all.push_back(row("scene", "t" + std::to_string(k), samples(random, factor, spread)));
  return run(all);
}

const ComparedRow& of(const Comparison& comparison, const std::string& technique) {
  for (const ComparedRow& r : comparison.rows)
    if (r.next->id.technique == technique) return r;
  throw std::runtime_error("no row of " + technique);
}

std::size_t count(const Comparison& comparison, Time verdict) {
  return std::size_t(std::count_if(comparison.rows.begin(), comparison.rows.end(),
                                   [&](const ComparedRow& r) { return r.time.verdict == verdict; }));
}

TEST(Compare, ARunWithItselfIsFine) {
  std::mt19937 random(1);
  const Results one = run_of(20, random, 0.3);
  const Comparison c = compare(one, one, {});
  EXPECT_EQ(c.exit_code(), 0);
  EXPECT_EQ(count(c, Time::same), 20u);
}

TEST(Compare, EqualsRaiseAFalseAlarmAtMostOnceInTwenty) {
  std::mt19937 random(2);
  int alarms = 0;
  constexpr int files = 400;
  for (int k = 0; k < files; ++k) {
    const Results base = run_of(12, random, 0.1), next = run_of(12, random, 0.1);
    const Comparison c = compare(base, next, {});
    alarms += count(c, Time::slower) + count(c, Time::faster) > 0;
  }
  EXPECT_LE(alarms, files / 20);
}

TEST(Compare, FindsOneSlowRowAmongMany) {
  std::mt19937 random(3);
  Results base = run_of(30, random, 0.03), next = run_of(30, random, 0.03);
  next.rows[7].timing.frame_ms = samples(random, 1.2, 0.03);
  const Comparison c = compare(base, next, {});
  EXPECT_EQ(c.exit_code(), 1);
  EXPECT_EQ(count(c, Time::slower), 1u);
  EXPECT_EQ(c.rows[0].name, next.rows[7].id.name()) << "the worst comes first";
  EXPECT_TRUE(c.rows[0].time.regressed);
  EXPECT_NEAR(c.rows[0].time.ratio, 1.2, 0.05);
  EXPECT_TRUE(c.rows[0].time.interval.contains(1.2));
  EXPECT_EQ(compare(base, next, {0.5, 0.05}).exit_code(), 0) << "slower, but no regression";
  EXPECT_EQ(compare(next, base, {}).rows[0].time.verdict, Time::faster);
  EXPECT_EQ(compare(next, base, {}).exit_code(), 0);
}

TEST(Compare, AMachineThatWasAnotherForEveryRowIsNoAlarm) {
  std::mt19937 random(4);
  std::normal_distribution<double> drift(0.0, 0.15);
  int alarms = 0;
  for (int k = 0; k < 100; ++k) {
    const Results base = run_of(20, random, 0.02);
    Results next = run_of(20, random, 0.02);
    for (Row& r : next.rows) {
      const double state = std::exp(drift(random));
      for (double& ms : r.timing.frame_ms) ms *= state;
    }
    const Comparison c = compare(base, next, {});
    alarms += count(c, Time::slower) + count(c, Time::faster) > 0;
    EXPECT_FALSE(c.notes.empty());
  }
  EXPECT_LE(alarms, 10);
}

TEST(Compare, AllRowsSlowerIsARegressionThatMayBeTheMachine) {
  std::mt19937 random(5);
  const Results base = run_of(20, random, 0.02);
  Results next = base;
  for (Row& r : next.rows)
    for (double& ms : r.timing.frame_ms) ms *= 1.2;
  const Comparison c = compare(base, next, {});
  EXPECT_EQ(c.exit_code(), 1);
  EXPECT_EQ(count(c, Time::slower), 20u);
  ASSERT_EQ(c.notes.size(), 1u);
  EXPECT_NE(c.notes[0].find("20 of 20 rows moved the same way (median 1.20x)"), std::string::npos) << c.notes[0];
}

TEST(Compare, WhatFewSamplesCannotProveIsUnknown) {
  EXPECT_EQ(compare(run({row("s", "t", {1.0, 1.1})}), run({row("s", "t", {1.5, 1.6})}), {}).exit_code(), 3);
  const Results one = run({row("s", "t", {1.0})});
  const Comparison c = compare(one, one, {});
  EXPECT_EQ(c.exit_code(), 3);
  EXPECT_NE(c.rows[0].time.why.find("one sample"), std::string::npos);
  EXPECT_EQ(compare(run({row("s", "t", {1.5, 1.6})}), run({row("s", "t", {1.0, 1.1})}), {}).exit_code(), 0)
      << "what may be faster is no regression";
}

TEST(Compare, SamplesThatScatterProveNothing) {
  const std::vector<double> calm = {1.0, 5.0, 9.0};
  for (const std::vector<double>& wild : {std::vector<double>{0.5, 5.1, 90.0}, {0.1, 3.0, 60.0}}) {
    const Comparison c = compare(run({row("s", "t", calm)}), run({row("s", "t", wild)}), {});
    EXPECT_EQ(c.exit_code(), 3);
    EXPECT_EQ(c.rows[0].time.verdict, Time::unknown);
    EXPECT_NE(c.rows[0].time.why.find("--repetitions"), std::string::npos) << "says what to do";
  }
  EXPECT_EQ(compare(run({row("s", "t", calm)}), run({row("s", "t", calm)}), {}).exit_code(), 0) << "the same samples";
}

TEST(Compare, AnErrorIsComparedWhereATimeCannotBe) {
  const std::vector<double> ms = {1.0, 1.1, 1.2};
  Row bad = row("s", "t", ms, 0.09);
  bad.status = "failed: its times cannot be used (0 ms)";
  EXPECT_EQ(compare(run({row("s", "t", ms)}), run({bad}), {}).exit_code(), 1);
  const Results twice = run({row("s", "t", ms, 0.03), row("s", "t", ms, 0.09)});
  EXPECT_EQ(compare(run({row("s", "t", ms)}), twice, {}).exit_code(), 1);
}

TEST(Compare, AFileFromElsewhereDoesNotEndIt) {
  const std::vector<double> ms = {1.0, 1.1, 1.2};
  Row failed = row("s", "t", ms);
  failed.status = "failed";  // no reason
  EXPECT_EQ(compare(run({row("s", "t", ms)}), run({failed}), {}).exit_code(), 1);
  Results one = run({row("s", "t", ms)});
  one.context["busy"] = "yes", one.context["session"] = {{"looks", "x"}};
  EXPECT_EQ(compare(one, one, {}).exit_code(), 0);
  one.rows[0].status = "skipped: no device";
  EXPECT_EQ(compare(one, one, {}).exit_code(), 3) << "nothing was measured";
}

TEST(Compare, TimesThatAreNoneAreSaid) {
  const std::vector<double> good = {1.0, 1.1, 1.2};
  for (const double bad : {0.0, -1.0, double(NAN), double(INFINITY)}) {
    for (const bool swapped : {false, true}) {
      const Results a = run({row("s", "t", good)}), b = run({row("s", "t", {1.0, bad, 1.2})});
      const Comparison c = swapped ? compare(b, a, {}) : compare(a, b, {});
      EXPECT_EQ(c.exit_code(), 3) << bad;
      EXPECT_NE(c.rows[0].time.why.find("a frame of"), std::string::npos) << c.rows[0].time.why;
    }
  }
  EXPECT_EQ(compare(run({row("s", "t", good)}), run({row("s", "t", {})}), {}).exit_code(), 3) << "no time any more";
  const Results untimed = run({row("s", "t", {})});
  EXPECT_EQ(compare(untimed, untimed, {}).exit_code(), 0) << "errors alone";
}

TEST(Compare, RowsWithoutAPartnerAreListed) {
  const std::vector<double> ms = {1.0, 1.1, 1.2};
  const Results a = run({row("s", "t", ms), row("s", "old", ms)}), b = run({row("s", "t", ms), row("s", "new", ms)});
  const Comparison c = compare(a, b, {});
  ASSERT_EQ(c.removed.size(), 1u);
  ASSERT_EQ(c.added.size(), 1u);
  EXPECT_NE(c.removed[0].find("old"), std::string::npos);
  EXPECT_NE(c.added[0].find("new"), std::string::npos);
  EXPECT_EQ(c.exit_code(), 3) << "a row is gone";
  EXPECT_EQ(compare(run({row("s", "t", ms)}), b, {}).exit_code(), 0) << "more rows are fine";
  EXPECT_EQ(compare(run({row("x", "t", ms)}), b, {}).exit_code(), 2) << "nothing in common";
}

TEST(Compare, ARowThatStandsTwiceIsComparedWithNothing) {
  const std::vector<double> ms = {1.0, 1.1, 1.2};
  const Results once = run({row("s", "t", ms)}), twice = run({row("s", "t", ms), row("s", "t", ms)});
  for (const Comparison& c : {compare(once, twice, {}), compare(twice, once, {}), compare(twice, twice, {})}) {
    EXPECT_EQ(c.exit_code(), 3);
    ASSERT_EQ(c.rows.size(), 1u);
    EXPECT_NE(c.rows[0].time.why.find("times in base"), std::string::npos);
  }
}

TEST(Compare, ParametersThatOnlyOneKnowsHaveTheirDefault) {
  const std::vector<double> ms = {1.0, 1.1, 1.2};
  Row old = row("s", "t", ms), now = old;
  old.id.parameters = {{"terms", 200}}, old.id.defaults = {{"terms", 100}};
  now.id.parameters = {{"terms", 200}, {"way", std::string("old")}};
  now.id.defaults = {{"terms", 200}, {"way", std::string("old")}};  // another default of what both know changes nothing
  EXPECT_EQ(compare(run({old}), run({now}), {}).exit_code(), 0);
  now.id.parameters["way"] = std::string("other");
  EXPECT_EQ(compare(run({old}), run({now}), {}).exit_code(), 2);
  now.id.parameters["way"] = std::string("old"), now.id.parameters["terms"] = 100;
  EXPECT_EQ(compare(run({old}), run({now}), {}).exit_code(), 2);
}

TEST(Compare, RowsThatFailNowAreRegressions) {
  const std::vector<double> ms = {1.0, 1.1, 1.2};
  Row good = row("s", "t", ms), failed = good, skipped = good;
  failed.status = "failed: out of ideas", skipped.status = "skipped: no device";
  const Comparison c = compare(run({good}), run({failed}), {});
  EXPECT_EQ(c.exit_code(), 1);
  EXPECT_EQ(c.rows[0].broken, "failed now: out of ideas");
  EXPECT_EQ(compare(run({good}), run({skipped}), {}).exit_code(), 3);
  EXPECT_EQ(compare(run({failed}), run({good}), {}).exit_code(), 0);
  EXPECT_EQ(compare(run({failed, row("s", "u", ms)}), run({failed, row("s", "u", ms)}), {}).unmeasured, 1u);
}

TEST(Compare, TimesOfOtherMachinesAreNotComparableButErrorsAre) {
  std::mt19937 random(6);
  const Results base = run_of(3, random, 0.01);
  for (const char* field : {"cpu_name", "flags", "compiler", "num_cpus"}) {
    Results next = base;
    next.context[field] = "other";
    for (Row& r : next.rows)
      for (double& ms : r.timing.frame_ms) ms *= 3.0;
    Comparison c = compare(base, next, {});
    EXPECT_EQ(c.exit_code(), 3) << field;
    EXPECT_EQ(count(c, Time::not_comparable), 3u);
    EXPECT_NE(c.notes[0].find(field), std::string::npos);
    next.rows[1].score.errors["truth"].report.all.rmse *= 2.0;
    c = compare(base, next, {});
    EXPECT_EQ(c.exit_code(), 1) << field;
    EXPECT_EQ(of(c, "t1").error.verdict, Error::worse);
  }
  Results other_scene = base;
  other_scene.rows[0].facts.scene_key = "of another mesh";
  EXPECT_EQ(of(compare(base, other_scene, {}), "t0").time.verdict, Time::not_comparable);
}

// --- side by side ----------------------------------------------------------------------------------------------------

/// Two rows of one session: launches whose processes differ by `between`, samples by `within`, and b slower by a
/// factor.
std::pair<Row, Row> session(std::mt19937& random, int launches, double between, double within, double factor) {
  std::normal_distribution<double> normal(0.0, 1.0);
  Row a = row("s", "t", {}), b = a;
  for (int l = 0; l < launches; ++l) {
    const double machine = std::exp(0.3 * normal(random));  // what it does to both
    const double of_a = std::exp(between * normal(random)), of_b = std::exp(between * normal(random));
    for (int k = 0; k < 5; ++k) {
      a.timing.frame_ms.push_back(machine * of_a * std::exp(within * normal(random)));
      b.timing.frame_ms.push_back(machine * of_b * factor * std::exp(within * normal(random)));
      a.timing.launch.push_back(l), b.timing.launch.push_back(l);
    }
  }
  return {a, b};
}

Comparison compare_session(const std::pair<Row, Row>& rows, const Thresholds& thresholds) {
  Results base = run({rows.first}), next = run({rows.second});
  base.context["session"] = next.context["session"] = session_context("one", 6);
  return compare(base, next, thresholds);
}

TEST(SideBySide, WhatDiffersBetweenProcessesIsNoAlarm) {
  std::mt19937 random(8);
  int alarms = 0;
  for (int k = 0; k < 300; ++k) alarms += compare_session(session(random, 8, 0.02, 0.001, 1.0), {}).rows[0].changed();
  EXPECT_LE(alarms, 15);
}

TEST(SideBySide, FindsTwoPercentThoughTheMachineMovesByThirty) {
  std::mt19937 random(9);
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    const Comparison c = compare_session(session(random, 18, 0.005, 0.02, 1.02), {0.01, 0.05});
    found += c.rows[0].time.verdict == Time::slower;
    EXPECT_TRUE(c.side_by_side);
  }
  EXPECT_GE(found, 90);
}

TEST(SideBySide, WhatIsNotCertainIsUnknown) {
  std::mt19937 random(10);
  EXPECT_EQ(compare_session(session(random, 5, 0.1, 0.1, 1.0), {0.01, 0.05}).exit_code(), 3);
  EXPECT_EQ(compare_session(session(random, 5, 0.001, 0.001, 1.0), {0.05, 0.05}).exit_code(), 0);
}

TEST(SideBySide, SamplesOfTwoSessionsAreNoPairs) {
  std::mt19937 random(11);
  const auto rows = session(random, 8, 0.001, 0.001, 1.0);
  Results base = run({rows.first}), next = run({rows.second});
  base.context["session"] = session_context("one", 6), next.context["session"] = session_context("two", 6);
  EXPECT_FALSE(compare(base, next, {}).rows[0].time.paired);
}

// --- errors ----------------------------------------------------------------------------------------------------------

ErrorComparison errors(double base, double next, const Thresholds& thresholds = {}) {
  return compare_errors(row("s", "t", {}, base), row("s", "t", {}, next), thresholds);
}

TEST(CompareErrors, AChangeOfTwiceTheNoiseFloorIsAlwaysFound) {
  const double twice = 2.0 * std::numbers::sqrt2 * noise;
  for (double base = 0.0; base < 0.5; base = 1.3 * base + 1e-4) {
    EXPECT_EQ(errors(base, base + twice).verdict, Error::worse) << base;
    EXPECT_EQ(errors(base + twice, base).verdict, Error::better) << base;
    Row other_truth = row("s", "t", {}, base + twice);
    other_truth.facts.scene_key = "same scene, another truth";
    EXPECT_EQ(compare_errors(row("s", "t", {}, base), other_truth, {}).verdict, Error::worse) << base;
  }
}

TEST(CompareErrors, NoNumberIsUnknown) {
  const Row good = row("s", "t", {}, 0.03);
  for (const double bad : {double(NAN), double(INFINITY), -0.03, 0.0}) {  // 0 contradicts the share that stays
    Row next = good;
    next.score.errors["truth"].report.all.rmse = bad;
    EXPECT_EQ(compare_errors(good, next, {}).verdict, Error::unknown) << bad;
    EXPECT_EQ(compare_errors(next, good, {}).verdict, Error::unknown) << bad;
  }
}

TEST(CompareErrors, NoiseAndRoundingAreNoChange) {
  EXPECT_EQ(errors(0.03, 0.03 * (1.0 + 1e-6)).verdict, Error::same);
  EXPECT_EQ(errors(0.0005, 0.0025).verdict, Error::same) << "both are what an exact image would have";
  const double of_noise = 8.0 * noise / 100.0;  // of 10,000 receivers
  EXPECT_EQ(errors(0.03, 0.03 + 0.9 * of_noise).verdict, Error::same);
  EXPECT_EQ(errors(0.03, 0.03 + 1.1 * of_noise).verdict, Error::worse);
  Row other_truth = row("s", "t", {}, 0.03 + 1.1 * of_noise);
  other_truth.facts.scene_key = "another truth";
  EXPECT_EQ(compare_errors(row("s", "t", {}, 0.03), other_truth, {}).verdict, Error::same)
      << "two truths have their noise each";
}

TEST(CompareErrors, OnlyBeyondTheThresholdIsARegression) {
  EXPECT_FALSE(errors(0.1, 0.104).regressed);
  EXPECT_TRUE(errors(0.1, 0.106).regressed);
  EXPECT_TRUE(errors(0.1, 0.104, {0.05, 0.01}).regressed);
  EXPECT_FALSE(errors(0.106, 0.1).regressed);
}

TEST(CompareErrors, TellTheRungThatChangedMost) {
  Row base = row("s", "t", {}), next = base;
  base.score.errors["spheres"] = next.score.errors["spheres"] = base.score.errors["truth"];
  next.score.errors["spheres"].report.all.rmse *= 1.5;
  const ErrorComparison c = compare_errors(base, next, {});
  EXPECT_EQ(c.rung, "spheres");
  EXPECT_TRUE(c.regressed);
  next.score.errors.erase("truth");
  next.score.errors["spheres"] = base.score.errors["spheres"];
  EXPECT_EQ(compare_errors(base, next, {}).verdict, Error::unknown) << "no truth to compare with any more";
  next.score.errors["truth"] = base.score.errors["truth"];
  next.score.errors["truth"].report.all.rmse = NAN;
  EXPECT_EQ(compare_errors(base, next, {}).verdict, Error::unknown);
}

TEST(CompareErrors, FramesOfAMotionCount) {
  Row base = row("s", "t", {}), next = base;
  base.score.sequence = next.score.sequence = SequenceErrors{{0.1, 0.2}, {0.01}, {}, noise, 0.0};
  next.score.sequence->rel_rmse = {0.1, 0.3};
  EXPECT_EQ(compare_errors(base, next, {}).rung, "frames");
  EXPECT_TRUE(compare_errors(base, next, {}).regressed);
}

}  // namespace
}  // namespace penumbra
