// Is a difference of times more than chance? Tests and intervals that comparisons rest on.
#pragma once

#include <vector>

namespace penumbra {

struct Interval {
  double low = 0.0, high = 0.0;
  bool within(double least, double most) const { return least < low && high < most; }
  bool contains(double value) const { return low <= value && value <= high; }
};

/// Probability that two sets of samples of one distribution lie as far apart as these, in either direction (Mann and
/// Whitney 1947): exact up to 20 samples each without equal ones, else normal with corrections for ties and continuity.
/// 1 where one set is empty.
double mann_whitney(const std::vector<double>& a, const std::vector<double>& b);

/// Probabilities of many tests, corrected so that below `alpha` there is a false one in at most that share of all
/// families of tests (Holm 1979).
std::vector<double> holm(const std::vector<double>& probabilities);

/// Of median(b) / median(a): percentiles of 1000 resamplings (Efron 1979), the same ones every time. Both have samples.
Interval bootstrap_ratio(std::vector<double> a, std::vector<double> b, double level);

/// Of the mean of the distribution that the values come from (Student 1908). Everything for fewer than two values.
Interval student_interval(const std::vector<double>& values, double level);

/// Probability of a mean as far from 0 as theirs, in either direction, if it is 0 (Student 1908). 1 for fewer than two.
double student_test(const std::vector<double>& values);

/// Changes (logarithms of ratios) of rows between two runs of one program scatter by more than their own errors
/// explain: the machine was another one for each. The standard deviation of that scatter about their median, from the
/// median of absolute deviations, which a few rows that really changed do not move. 0 for fewer than eight rows.
double drift_between_runs(const std::vector<double>& changes, const std::vector<double>& errors);

/// Probability that a change of this size, either way, comes from its own error and from drift. That was estimated from
/// so many rows, from a median, which is worth 37 % of them (Student 1908).
double drift_test(double change, double error, double drift, std::size_t rows);

}  // namespace penumbra
