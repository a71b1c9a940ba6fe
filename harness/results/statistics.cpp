#include "harness/results/statistics.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace penumbra {
namespace {

/// The sample that a share of all lies below; between two samples, the straight line.
double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * double(sorted.size() - 1);
  const auto below = std::size_t(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - double(below));
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

double spread(std::vector<double> values) {
  if (values.size() < 2) return 0.0;
  std::sort(values.begin(), values.end());
  return 0.5 * (quantile(values, 0.75) - quantile(values, 0.25));
}

double student_quantile(double level, double degrees) {
  return boost::math::quantile(complement(boost::math::students_t(degrees), 0.5 * (1.0 - level)));
}

std::optional<double> mean_defined(const std::vector<std::optional<double>>& values) {
  double sum = 0.0;
  int count = 0;
  for (const auto& value : values)
    if (value) sum += *value, ++count;
  return count ? std::optional(sum / count) : std::nullopt;
}

}  // namespace penumbra
