#include "harness/results/log_log.h"

#include <gmock/gmock.h>

#include <cmath>

namespace penumbra {
namespace {

using testing::HasSubstr;

std::vector<CurvePoint> power(double factor, double exponent, const std::vector<double>& at, double noise = 0.0) {
  std::vector<CurvePoint> points;
  points.reserve(at.size());
  for (const double x : at) points.push_back({x, factor * std::pow(x, exponent), noise});
  return points;
}

TEST(LogLog, ReadsPowersExactlyBetweenPoints) {
  const auto points = power(3.0, -0.5, {1.0, 16.0, 100.0});
  for (const double x : {1.0, 2.0, 16.0, 50.0, 100.0}) EXPECT_NEAR(*log_log_at(points, x), 3.0 / std::sqrt(x), 1e-12);
  EXPECT_EQ(*log_log_at(points, 16.0), 0.75) << "a point is what was measured";
}

TEST(LogLog, IsGeometricMeanHalfway) {
  EXPECT_NEAR(*log_log_at({{1.0, 2.0}, {4.0, 18.0}, {400.0, 18.0}}, 2.0), 6.0, 1e-12);
  EXPECT_NEAR(*log_log_at({{1.0, 2.0}, {4.0, 18.0}, {400.0, 18.0}}, 77.0), 18.0, 1e-12);
}

TEST(LogLog, NeverReadsBeyondThePoints) {
  const auto points = power(1.0, 1.0, {2.0, 8.0});
  EXPECT_FALSE(log_log_at(points, 1.999));
  EXPECT_FALSE(log_log_at(points, 8.001));
  EXPECT_FALSE(log_log_at(points, std::nan("")));
  EXPECT_FALSE(log_log_at({}, 1.0));
  EXPECT_EQ(log_log_at({{2.0, 5.0}}, 2.0), 5.0) << "one point is a curve of one place";
  EXPECT_FALSE(log_log_at({{2.0, 5.0}}, 2.1));
}

TEST(LogLog, SlopeOfAPowerIsItsExponent) {
  const auto fit = log_log_slope(power(0.3, 0.9, {32, 64, 96, 128}));
  ASSERT_TRUE(fit.value) << fit.refused;
  EXPECT_NEAR(fit.value->slope, 0.9, 1e-12);
  EXPECT_NEAR(fit.value->low, 0.9, 1e-6) << "nothing scatters";
  EXPECT_NEAR(fit.value->high, 0.9, 1e-6);
}

// By hand: log x = 0, 1, 2, 3 and log y = 0, 2, 1, 3 have slope 0.8 and residuals -0.3, 0.9, -0.9, 0.3 (sum of squares
// 1.8, 2 degrees of freedom), so its standard error is sqrt(0.9 / 5); Student's t of 95 % and 2 degrees is 4.302653.
TEST(LogLog, SlopeHasStudentsInterval) {
  std::vector<CurvePoint> points;
  const double e = std::exp(1.0), y[] = {0, 2, 1, 3};
  for (int k = 3; k >= 0; --k) points.push_back({std::pow(e, k), std::pow(e, y[k])});
  const auto fit = log_log_slope(points);
  ASSERT_TRUE(fit.value) << fit.refused;
  EXPECT_NEAR(fit.value->slope, 0.8, 1e-12);
  EXPECT_NEAR(fit.value->high - 0.8, 4.302653 * std::sqrt(0.18), 1e-6);
  EXPECT_NEAR(0.8 - fit.value->low, 4.302653 * std::sqrt(0.18), 1e-6);
}

TEST(LogLog, SlopeNeedsThreeDifferentValues) {
  EXPECT_THAT(log_log_slope({}).refused, HasSubstr("there are 0"));
  EXPECT_THAT(log_log_slope(power(1, 1, {1, 2})).refused, HasSubstr("there are 2"));
  EXPECT_THAT(log_log_slope(power(1, 1, {1, 2, 2, 1})).refused, HasSubstr("there are 2"));
  EXPECT_THAT(log_log_slope({{1, 1}, {2, 2}, {0, 3}, {4, std::nan("")}, {5, -1}}).refused, HasSubstr("there are 2"));
  EXPECT_TRUE(log_log_slope(power(1, 1, {1, 2, 3})).value);
  EXPECT_NEAR(log_log_slope({{1, 1}, {2, 2}, {0, 3}, {4, 4}, {4, 4}}).value->slope, 1.0, 1e-12) << "0 has no logarithm";
}

TEST(LogLog, CurvesCrossWhereTheirPowersDo) {
  // 0.1 x and 2 sqrt(x) meet at x = 400.
  const auto steep = power(0.1, 1.0, {10, 100, 1000}), flat = power(2.0, 0.5, {20, 300, 2000});
  const auto found = log_log_crossing(steep, flat), swapped = log_log_crossing(flat, steep);
  ASSERT_TRUE(found.value && swapped.value) << found.refused << swapped.refused;
  EXPECT_NEAR(found.value->at, 400.0, 1e-9);
  EXPECT_TRUE(found.value->first_is_less_below);
  EXPECT_NEAR(swapped.value->at, 400.0, 1e-9);
  EXPECT_FALSE(swapped.value->first_is_less_below);
}

TEST(LogLog, CurvesCrossAtACommonPoint) {
  const auto found = log_log_crossing({{1, 1}, {2, 2}, {4, 4}}, {{1, 2}, {2, 2}, {4, 2}});
  ASSERT_TRUE(found.value) << found.refused;
  EXPECT_EQ(found.value->at, 2.0);
  EXPECT_TRUE(found.value->first_is_less_below);
}

TEST(LogLog, CrossingIsRefusedWithItsReason) {
  const auto why = [](const std::vector<CurvePoint>& a, const std::vector<CurvePoint>& b) {
    const auto found = log_log_crossing(a, b);
    EXPECT_FALSE(found.value);
    return found.refused;
  };
  EXPECT_THAT(why({}, {{1, 1}, {2, 2}}), HasSubstr("no point"));
  EXPECT_THAT(why({{1, 1}, {2, 2}}, {{2, 1}, {4, 2}}), HasSubstr("no stretch in common"));
  EXPECT_THAT(why({{1, 1}, {2, 2}}, {{4, 1}, {8, 2}}), HasSubstr("1 to 2 and 4 to 8")) << "lines would meet outside";
  EXPECT_THAT(why({{1, 1}, {2, 2}}, {{1, 3}, {2, 4}}), HasSubstr("never cross from 1 to 2: the first is less"));
  EXPECT_THAT(why({{1, 5}, {2, 6}}, {{1, 3}, {2, 4}}), HasSubstr("the second is less"));
  EXPECT_THAT(why({{1, 1}, {2, 3}, {4, 1}}, {{1, 2}, {4, 2}}), HasSubstr("cross 2 times"));
  EXPECT_THAT(why({{1, 1}, {2, 2}, {4, 1}}, {{1, 2}, {4, 2}}), HasSubstr("never cross")) << "they touch";
  EXPECT_THAT(why({{1, 1}, {2, 2}}, {{1, 1}, {2, 2}}), HasSubstr("both are equal"));
  EXPECT_THAT(why({{1, 1}, {2, 2}, {4, 2}, {8, 3}}, {{1, 2}, {8, 2}}), HasSubstr("run together from 2 to 4"));
}

TEST(LogLog, CrossingWithinNoiseIsNone) {
  const auto found = log_log_crossing({{1, 1.0, 0.2}, {4, 4, 0.2}}, {{1, 1.3, 0.2}, {4, 1.3, 0.2}});
  EXPECT_THAT(found.refused, HasSubstr("noise"));
  EXPECT_TRUE(log_log_crossing({{1, 1.0, 0.1}, {4, 4, 0.2}}, {{1, 1.3, 0.1}, {4, 1.3, 0.2}}).value);
}

TEST(LogLog, TheLeastOfEqualPlacesCounts) {
  const auto found = log_log_crossing({{1, 1}, {4, 4}, {1, 9}, {4, 16}}, {{1, 2}, {4, 2}});
  ASSERT_TRUE(found.value) << found.refused;
  EXPECT_NEAR(found.value->at, 2.0, 1e-12);
}

}  // namespace
}  // namespace penumbra
