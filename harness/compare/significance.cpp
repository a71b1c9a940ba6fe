#include "harness/compare/significance.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "harness/results/statistics.h"

namespace penumbra {
namespace {

constexpr std::size_t most_exact = 20;

/// Both tails of a standard normal distribution.
double two_sided(double z) {
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
}

double two_sided_student(double t, double degrees) {
  return 2.0 * boost::math::cdf(complement(boost::math::students_t(degrees), std::abs(t)));
}

/// How many of the orders of a and b samples have each value of U, as shares of all: N(u; a, b) = N(u - b; a - 1, b) +
/// N(u; a, b - 1), by whether the last sample is of the first set.
std::vector<double> shares_of_u(std::size_t a, std::size_t b) {
  std::vector<std::vector<double>> counts(b + 1, std::vector<double>(a * b + 1));
  for (auto& of_none : counts) of_none[0] = 1.0;
  for (std::size_t i = 1; i <= a; ++i) {
    std::fill(counts[0].begin(), counts[0].end(), 0.0);
    counts[0][0] = 1.0;
    for (std::size_t j = 1; j <= b; ++j)
      for (std::size_t u = a * b + 1; u-- > 0;) counts[j][u] = (u >= j ? counts[j][u - j] : 0.0) + counts[j - 1][u];
  }
  std::vector<double> shares = counts[b];
  const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= all;
  return shares;
}

/// The same probabilities for every row of a file.
const std::vector<double>& cached_shares(std::size_t a, std::size_t b) {
  thread_local std::vector<double> known[most_exact + 1][most_exact + 1];
  std::vector<double>& shares = known[a][b];
  if (shares.empty()) shares = shares_of_u(a, b);
  return shares;
}

struct Ranks {
  double u = 0.0;     ///< pairs in which the sample of a is the larger; of equal ones, half
  double ties = 0.0;  ///< sum of t^3 - t over groups of equal samples
};

Ranks ranks_of(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<std::pair<double, bool>> all;
  all.reserve(a.size() + b.size());
  for (const double x : a) all.emplace_back(x, true);
  for (const double x : b) all.emplace_back(x, false);
  std::sort(all.begin(), all.end());
  Ranks ranks;
  double sum = 0.0;  // of the ranks of a
  for (std::size_t k = 0, end = 0; k < all.size(); k = end) {
    std::size_t of_a = 0;
    for (end = k; end < all.size() && all[end].first == all[k].first; ++end) of_a += all[end].second;
    const auto equal = double(end - k);
    sum += double(of_a) * (double(k + end + 1) / 2.0);
    ranks.ties += equal * equal * equal - equal;
  }
  ranks.u = sum - double(a.size()) * double(a.size() + 1) / 2.0;
  return ranks;
}

constexpr int resamplings = 1000;

using Places = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Which two of n sorted samples the median lies between, in every resampling; that depends on their number alone.
Places resampled_medians(std::size_t n) {
  std::minstd_rand random(std::uint32_t(20110405 + n));
  Places medians(resamplings);
  std::vector<std::uint32_t> drawn(n);
  for (auto& [below, above] : medians) {
    for (std::uint32_t& index : drawn) index = std::uint32_t(random() % n);
    std::sort(drawn.begin(), drawn.end());
    below = drawn[(n - 1) / 2], above = drawn[n / 2];
  }
  return medians;
}

const Places& cached_medians(std::size_t n, int which) {
  thread_local std::map<std::size_t, Places> known[2];
  Places& medians = known[which][n];
  if (medians.empty()) {
    medians = resampled_medians(n);
    // The two sets are drawn independently.
    if (which == 1) std::shuffle(medians.begin(), medians.end(), std::minstd_rand(19790101));
  }
  return medians;
}

double standard_error(const std::vector<double>& values, double mean) {
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / double(values.size() - 1) / double(values.size()));
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

}  // namespace

double mann_whitney(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.empty() || b.empty()) return 1.0;
  const auto [u, ties] = ranks_of(a, b);
  const auto n = double(a.size()), m = double(b.size()), all = n + m;
  if (ties == 0.0 && a.size() <= most_exact && b.size() <= most_exact) {
    const std::vector<double>& shares = cached_shares(a.size(), b.size());
    const auto tail = std::ptrdiff_t(std::min(u, n * m - u)) + 1;
    return std::min(1.0, 2.0 * std::accumulate(shares.begin(), shares.begin() + tail, 0.0));
  }
  const double variance = n * m / 12.0 * (all + 1.0 - ties / (all * (all - 1.0)));
  if (!(variance > 0.0)) return 1.0;  // all samples are equal
  return std::min(1.0, two_sided(std::max(0.0, std::abs(u - 0.5 * n * m) - 0.5) / std::sqrt(variance)));
}

std::vector<double> holm(const std::vector<double>& probabilities) {
  std::vector<std::size_t> order(probabilities.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return probabilities[i] < probabilities[j]; });
  std::vector<double> corrected(probabilities.size());
  double least = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    least = std::max(least, std::min(1.0, double(order.size() - k) * probabilities[order[k]]));
    corrected[order[k]] = least;
  }
  return corrected;
}

Interval bootstrap_ratio(std::vector<double> a, std::vector<double> b, double level) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  const auto &of_a = cached_medians(a.size(), 0), &of_b = cached_medians(b.size(), 1);
  std::vector<double> ratios(resamplings);
  for (int k = 0; k < resamplings; ++k)
    ratios[k] = (b[of_b[k].first] + b[of_b[k].second]) / (a[of_a[k].first] + a[of_a[k].second]);
  const auto quantile = [&](double at) {
    const auto place = ratios.begin() + std::ptrdiff_t(at);
    std::nth_element(ratios.begin(), place, ratios.end());
    return *place;
  };
  const double tail = 0.5 * (1.0 - level) * (resamplings - 1);
  return {quantile(std::floor(tail)), quantile(std::ceil(resamplings - 1 - tail))};
}

Interval student_interval(const std::vector<double>& values, double level) {
  constexpr double all = std::numeric_limits<double>::infinity();
  if (values.size() < 2) return {-all, all};
  const double mean = mean_of(values);
  const double reach = student_quantile(level, double(values.size() - 1)) * standard_error(values, mean);
  return {mean - reach, mean + reach};
}

double student_test(const std::vector<double>& values) {
  if (values.size() < 2) return 1.0;
  const double mean = mean_of(values), error = standard_error(values, mean);
  if (mean == 0.0 || !(error > 0.0)) return mean == 0.0 ? 1.0 : 0.0;
  return two_sided_student(mean / error, double(values.size() - 1));
}

double drift_between_runs(const std::vector<double>& changes, const std::vector<double>& errors) {
  if (changes.size() < 8) return 0.0;
  const double middle = median(changes);
  std::vector<double> distances, own;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    distances.push_back(std::abs(changes[k] - middle));
    own.push_back(errors[k] * errors[k]);
  }
  const double scatter = 1.4826 * median(distances);  // of a normal distribution, its standard deviation
  return std::sqrt(std::max(0.0, scatter * scatter - median(own)));
}

double drift_test(double change, double error, double drift, std::size_t rows) {
  const double deviation = std::hypot(error, drift);
  if (!(deviation > 0.0)) return change == 0.0 ? 1.0 : 0.0;
  return two_sided_student(change / deviation, std::max(1.0, 0.37 * (double(rows) - 1.0)));
}

}  // namespace penumbra
