// Tests of statistics, against tables and worked examples.
#include "harness/compare/significance.h"

#include <cmath>
#include <random>

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(MannWhitney, HasTheExactProbabilitiesOfSmallSets) {
  EXPECT_NEAR(mann_whitney({1, 2, 3}, {4, 5, 6}), 2.0 / 20.0, 1e-12);
  EXPECT_NEAR(mann_whitney({4, 5, 6}, {1, 2, 3}), 2.0 / 20.0, 1e-12);
  EXPECT_NEAR(mann_whitney({1, 2, 4}, {3, 5, 6}), 4.0 / 20.0, 1e-12);  // U = 1
  // Hollander and Wolfe 1973, p. 69: W = 30 of 5 and 10 samples, one-sided 0.1272.
  const std::vector<double> term = {0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46};
  EXPECT_NEAR(mann_whitney(term, {1.15, 0.88, 0.90, 0.74, 1.21}), 2.0 * 0.1272, 1e-4);
}

TEST(MannWhitney, CountsTiesAndManySamplesByTheNormalDistribution) {
  EXPECT_DOUBLE_EQ(mann_whitney({1, 1, 1}, {1, 1, 1}), 1.0);
  EXPECT_DOUBLE_EQ(mann_whitney({}, {1}), 1.0);
  // Ranks 1 2.5 2.5 4 | 5 6.5 6.5 8: U = 0, variance 16 / 12 (9 - 12 / 56), z = 7.5 / sqrt(11.714) = 2.191.
  EXPECT_NEAR(mann_whitney({1, 2, 2, 3}, {4, 5, 5, 6}), 0.02843, 1e-5);
}

TEST(MannWhitney, OfNineSamplesEachIsAtLeastTwoIn48620) {
  EXPECT_NEAR(mann_whitney({1, 2, 3, 4, 5, 6, 7, 8, 9}, {10, 11, 12, 13, 14, 15, 16, 17, 18}), 2.0 / 48620.0, 1e-12);
}

TEST(Holm, IsItsAuthorsExample) {
  const std::vector<double> corrected = holm({0.01, 0.04, 0.03, 0.005});
  EXPECT_NEAR(corrected[3], 0.02, 1e-12);
  EXPECT_NEAR(corrected[0], 0.03, 1e-12);
  EXPECT_NEAR(corrected[2], 0.06, 1e-12);
  EXPECT_NEAR(corrected[1], 0.06, 1e-12) << "never below one that is smaller uncorrected";
  EXPECT_TRUE(holm({}).empty());
  EXPECT_EQ(holm({0.9, 0.8})[0], 1.0);
}

TEST(Student, IntervalsAndTestsAreThoseOfTheTable) {
  const Interval interval = student_interval({1, 2, 3}, 0.95);  // t of 2 degrees of freedom: 4.3027
  EXPECT_NEAR(interval.low, 2.0 - 4.3027 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(interval.high, 2.0 + 4.3027 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(student_test({1, 2, 3}), 0.07418, 1e-5);  // t = 3.4641
  EXPECT_DOUBLE_EQ(student_test({0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(student_test({1, 1}), 0.0);
  EXPECT_FALSE(std::isfinite(student_interval({1}, 0.95).high));
  EXPECT_DOUBLE_EQ(student_test({1}), 1.0);
}

TEST(Bootstrap, IntervalsHoldTheRatioAsOftenAsTheySay) {
  std::mt19937 random(5);
  std::lognormal_distribution<double> noise(0.0, 0.1);
  int held = 0;
  constexpr int files = 400;
  for (int k = 0; k < files; ++k) {
    std::vector<double> a(15), b(15);
    for (double& x : a) x = noise(random);
    for (double& x : b) x = 1.3 * noise(random);
    held += bootstrap_ratio(a, b, 0.95).contains(1.3);
  }
  EXPECT_GT(held, files * 90 / 100);
  EXPECT_LT(held, files * 99 / 100 + 1);
  EXPECT_EQ(bootstrap_ratio({2, 2}, {3, 3}, 0.95).low, 1.5);
}

TEST(Drift, IsWhatRowsScatterBeyondTheirOwnErrors) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> changes(1000), errors(1000, 0.03);
  for (double& c : changes) c = 0.2 + 0.04 * noise(random) + 0.03 * noise(random);  // and all are slower by 0.2
  EXPECT_NEAR(drift_between_runs(changes, errors), 0.04, 0.005);
  for (int k = 0; k < 100; ++k) changes[k] += 1.0;  // a few that really changed do not matter much
  EXPECT_NEAR(drift_between_runs(changes, errors), 0.045, 0.01);
  EXPECT_DOUBLE_EQ(drift_between_runs(std::vector<double>(20, 0.2), std::vector<double>(20, 0.0)), 0.0);
  EXPECT_DOUBLE_EQ(drift_between_runs({0, 1, 2}, {0, 0, 0}), 0.0) << "three rows do not tell";
}

TEST(Drift, MakesChangesOfItsSizeProbable) {
  EXPECT_NEAR(drift_test(1.96 * 0.05, 0.03, 0.04, 100000), 0.05, 1e-3);
  EXPECT_NEAR(drift_test(-1.96 * 0.05, 0.03, 0.04, 100000), 0.05, 1e-3);
  EXPECT_NEAR(drift_test(2.262 * 0.05, 0.03, 0.04, 25), 0.05, 2e-3) << "some nine rows' worth";
  EXPECT_DOUBLE_EQ(drift_test(0.0, 0.0, 0.0, 9), 1.0);
}

}  // namespace
}  // namespace penumbra
