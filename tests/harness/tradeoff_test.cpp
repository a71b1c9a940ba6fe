#include "harness/results/tradeoff.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "harness/results/derived.h"
#include "tests/harness/trade_rows.h"

namespace penumbra {
namespace {

using test::pointers;
using test::trade_row;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<double> times_of(const std::vector<TradePoint>& envelope) {
  std::vector<double> times;
  times.reserve(envelope.size());
  for (const TradePoint& point : envelope) times.push_back(point.ms);
  return times;
}

/// Rays: the error falls with the square root of the time, 10 % at 1 ms.
std::vector<Row> rays() {
  return {trade_row("rays", 1, 0.1), trade_row("rays", 4, 0.05), trade_row("rays", 100, 0.01)};
}

TEST(Tradeoff, EnvelopeKeepsWhatIsNearerThanEverythingFaster) {
  const std::vector<Row> rows = {trade_row("a", 3, 0.02), trade_row("a", 1, 0.1),  trade_row("a", 2, 0.1),
                                 trade_row("a", 4, 0.03), trade_row("a", 3, 0.02), trade_row("a", 5, 0.01)};
  EXPECT_THAT(times_of(lower_envelope(pointers(rows))), ElementsAre(1, 3, 5)) << "a duplicate stands there once";
  EXPECT_TRUE(lower_envelope({}).empty());
}

TEST(Tradeoff, RowsThatAreNoPointsSayWhy) {
  Row failed = trade_row("a", 1, 0.1), broken = trade_row("a", 1, 0.1), unscored = trade_row("a", 1, 0.1);
  failed.status = "failed: x", broken.timing.frame_ms = {std::nan("")}, unscored.score.errors.clear();
  Row zero_time = trade_row("a", 1, 0.1);
  zero_time.timing.frame_ms = {0.0};
  const std::pair<Row, const char*> cases[] = {{failed, "not measured"},
                                               {trade_row("a", 0, 0.1), "no time"},
                                               {broken, "time cannot be used"},
                                               {zero_time, "time cannot be used"},
                                               {unscored, "undefined"},
                                               {trade_row("a", 1, std::nullopt), "undefined"},
                                               {trade_row("a", 1, std::nan("")), "undefined"},
                                               {trade_row("a", 1, 0.0), "error is 0"}};
  for (const auto& [row, why] : cases) {
    EXPECT_THAT(trade_point(row).refused, HasSubstr(why));
    EXPECT_THAT(speed_up(row, lower_envelope({&row})).refused, HasSubstr(why));
    EXPECT_TRUE(lower_envelope({&row}).empty());
  }
}

TEST(Tradeoff, TiesStandAtTheFloorOfTheTruth) {
  const Row exact = trade_row("a", 1, 0.0, 0.01), tie = trade_row("a", 2, 0.004, 0.01),
            far = trade_row("a", 1, 0.1, 0.01);
  EXPECT_NEAR(trade_point(exact).value->error, 0.01 * std::numbers::sqrt2, 1e-15);
  EXPECT_TRUE(trade_point(exact).value->tie && trade_point(tie).value->tie);
  EXPECT_FALSE(trade_point(far).value->tie);
  EXPECT_THAT(times_of(lower_envelope({&exact, &tie})), ElementsAre(1)) << "among ties, the faster";
}

TEST(Tradeoff, ReadsRaysByTheirLaw) {
  const std::vector<Row> rows = rays();
  const auto curve = lower_envelope(pointers(rows));
  for (const double error : {0.1, 0.07, 0.05, 0.02, 0.01}) {
    const auto ms = time_at_error(error, curve);
    ASSERT_TRUE(ms.value) << ms.refused;
    EXPECT_NEAR(ms.value->value, 0.01 / (error * error), 1e-9) << error;
    EXPECT_EQ(ms.value->bound, Bound::exact);
  }
  for (const double ms : {1.0, 2.0, 4.0, 50.0, 100.0})
    EXPECT_NEAR(error_at_time(ms, curve).value->value, 0.1 / std::sqrt(ms), 1e-12) << ms;
}

TEST(Tradeoff, NothingIsReadOutsideOfWhatWasMeasured) {
  const std::vector<Row> rows = rays();
  const auto curve = lower_envelope(pointers(rows));
  EXPECT_THAT(time_at_error(0.009, curve).refused, HasSubstr("below the measured errors, 1 % to 10 %"));
  EXPECT_THAT(time_at_error(0.2, curve).refused, HasSubstr("above the measured errors"));
  EXPECT_THAT(time_at_error(0.0, curve).refused, HasSubstr("0 has no place"));
  EXPECT_THAT(time_at_error(std::nan(""), curve).refused, HasSubstr("has no place"));
  EXPECT_THAT(error_at_time(0.5, curve).refused, HasSubstr("below the measured times, 1 ms to 100 ms"));
  EXPECT_THAT(error_at_time(101, curve).refused, HasSubstr("above the measured times"));
  EXPECT_THAT(time_at_error(0.02, {}).refused, HasSubstr("no row"));
  EXPECT_THAT(error_at_time(1, {}).refused, HasSubstr("no row"));
  const auto one = lower_envelope({&rows[1]});
  EXPECT_EQ(time_at_error(0.05, one).value->value, 4.0) << "one row is known in one place";
  EXPECT_EQ(error_at_time(4.0, one).value->value, 0.05);
  EXPECT_THAT(time_at_error(0.051, one).refused, HasSubstr("above the measured errors, 5 % alone"));
}

TEST(Tradeoff, ReadingsBesideATieAreBounds) {
  const double floor = 0.01 * std::numbers::sqrt2;
  const std::vector<Row> rows = {trade_row("a", 1, 0.1, 0.01), trade_row("a", 2, 0.05, 0.01),
                                 trade_row("a", 9, 0.003, 0.01)};
  const auto curve = lower_envelope(pointers(rows));
  EXPECT_EQ(time_at_error(0.07, curve).value->bound, Bound::exact);
  EXPECT_EQ(time_at_error(0.05, curve).value->bound, Bound::exact) << "that row was measured";
  EXPECT_EQ(time_at_error(0.03, curve).value->bound, Bound::at_most);
  EXPECT_EQ(time_at_error(floor, curve).value->value, 9.0);
  EXPECT_EQ(time_at_error(floor, curve).value->bound, Bound::at_most);
  EXPECT_EQ(error_at_time(5, curve).value->bound, Bound::at_most);
  EXPECT_EQ(error_at_time(9, curve).value->value, floor);
  EXPECT_FALSE(time_at_error(0.01, curve).value) << "nobody can say who is nearer than the floor";
}

TEST(Tradeoff, SpeedUpIsTheCurvesTimeOverTheRows) {
  const std::vector<Row> rows = rays();
  const auto curve = lower_envelope(pointers(rows));
  const auto factor = speed_up(trade_row("b", 5, 0.02), curve);
  ASSERT_TRUE(factor.value) << factor.refused;
  EXPECT_NEAR(factor.value->value, 25.0 / 5.0, 1e-9);
  EXPECT_NEAR(speed_up(rows[1], curve).value->value, 1.0, 1e-12) << "of the curve over itself";
  EXPECT_THAT(speed_up(trade_row("b", 5, 0.3), curve).refused, HasSubstr("30 % is above"));
}

TEST(Tradeoff, SpeedUpSaysWhichWayATieBoundsIt) {
  const double noise = 0.01, floor = noise * std::numbers::sqrt2;
  const Row near = trade_row("b", 1, 0.002, noise), middle = trade_row("b", 1, 0.03, noise);
  const std::vector<Row> with_tie = {trade_row("r", 4, 0.05, noise), trade_row("r", 20, 0.001, noise)};
  const std::vector<Row> without = {trade_row("r", 4, 0.05, noise), trade_row("r", 20, floor, noise)};
  const auto ties = lower_envelope(pointers(with_tie)), exact = lower_envelope(pointers(without));
  EXPECT_EQ(speed_up(near, ties).value->bound, Bound::of_ties);
  EXPECT_EQ(speed_up(near, ties).value->value, 20.0);
  EXPECT_EQ(speed_up(near, exact).value->bound, Bound::at_least);
  EXPECT_EQ(speed_up(middle, ties).value->bound, Bound::at_most);
  EXPECT_EQ(speed_up(middle, exact).value->bound, Bound::exact);
}

TEST(Tradeoff, TheMostEfficientBackendIsThatOfLeastTimeTimesSquaredError) {
  std::vector<Row> rows = rays();
  for (Row row : rays()) {
    row.id.backend = "scalar", row.timing.frame_ms[0] *= 3.0;
    rows.push_back(row);
  }
  Row coarse = trade_row("rays", 0.5, 0.9);  // the fastest of all rows, and the worst
  coarse.id.backend = "other";
  rows.insert(rows.begin(), coarse);
  const auto best = most_efficient(pointers(rows));
  ASSERT_EQ(best.size(), 3u);
  for (const Row* row : best) EXPECT_EQ(row->id.backend, "simd");
  Row lucky = trade_row("rays", 0.1, 0.05);  // one row makes no curve beside three
  lucky.id.backend = "lucky";
  rows.push_back(lucky);
  EXPECT_EQ(most_efficient(pointers(rows)).size(), 3u);
  EXPECT_EQ(most_efficient({&rows.back()}).size(), 1u) << "but is what there is without them";
  EXPECT_TRUE(most_efficient({}).empty());
  const Row untimed = trade_row("rays", 0, 0.1);
  EXPECT_TRUE(most_efficient({&untimed}).empty());
}

TEST(Tradeoff, EfficiencyDoesNotDependOnHowManySamplesWereTaken) {
  // The fast one was measured with many samples, the other, which takes twice as long for an error, with few.
  std::vector<Row> rows = {trade_row("rays", 25, 0.02), trade_row("rays", 100, 0.01), trade_row("rays", 2, 0.1),
                           trade_row("rays", 8, 0.05)};
  rows[2].id.backend = rows[3].id.backend = "scalar";
  const auto best = most_efficient(pointers(rows));
  EXPECT_THAT(best, ElementsAre(&rows[0], &rows[1]));
}

/// 40 rows of coarse times and errors, so that many are equal.
std::vector<Row> some_rows(unsigned seed) {
  std::minstd_rand random(seed);
  std::vector<Row> rows;
  rows.reserve(40);
  for (int k = 0; k < 40; ++k)
    rows.push_back(trade_row("t", 1.0 + double(random() % 12), 0.01 * double(random() % 12), 0.02));
  return rows;
}

TEST(Tradeoff, NothingOnTheFrontIsBeatenAndAllElseIs) {
  const auto beats = [](const Row& a, const Row& b) {
    return (faster(a, b) && !nearer(b, a)) || (nearer(a, b) && !faster(b, a));
  };
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const std::vector<Row> rows = some_rows(seed);
    const std::vector<bool> optimal = pareto_optimal(pointers(rows));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool beaten =
          std::any_of(rows.begin(), rows.end(), [&](const Row& other) { return beats(other, rows[i]); });
      EXPECT_EQ(optimal[i], !beaten) << seed << " row " << i;
    }
  }
}

TEST(Tradeoff, EveryRowLiesOnTheEnvelopeOrAboveIt) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const std::vector<Row> rows = some_rows(seed);
    const auto envelope = lower_envelope(pointers(rows));
    for (std::size_t k = 1; k < envelope.size(); ++k)
      EXPECT_TRUE(envelope[k - 1].ms < envelope[k].ms && envelope[k - 1].error > envelope[k].error);
    for (const Row& row : rows) {
      const TradePoint point = *trade_point(row).value;
      EXPECT_TRUE(std::any_of(envelope.begin(), envelope.end(), [&](const TradePoint& on) {
        return on.ms <= point.ms && on.error <= point.error;
      })) << seed;
    }
  }
}

}  // namespace
}  // namespace penumbra
