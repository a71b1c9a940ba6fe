#include "harness/results/scaling.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/harness/trade_rows.h"

namespace penumbra {
namespace {

using test::pointers;
using testing::HasSubstr;

struct Spec {
  std::string technique;
  int spheres, terms, threads;
  double ms;
  std::string scene = "s";
};

Row row_of(const Spec& spec) {
  Row row = test::trade_row(spec.technique, spec.ms, 0.1);
  row.id.scene = spec.scene, row.id.reads_spheres = spec.spheres > 0, row.id.spheres = std::size_t(spec.spheres);
  row.id.threads = spec.threads;
  if (spec.terms > 0) row.id.parameters["terms"] = spec.terms;
  row.id.parameters["mode"] = std::string("plain");
  return row;
}

std::vector<Row> rows_of(const std::vector<Spec>& specs) {
  std::vector<Row> rows;
  rows.reserve(specs.size());
  for (const Spec& spec : specs) rows.push_back(row_of(spec));
  return rows;
}

const ScalingCurve* over(const std::string& axis, const std::vector<ScalingCurve>& curves) {
  for (const ScalingCurve& curve : curves)
    if (curve.axis == axis) return &curve;
  return nullptr;
}

TEST(Scaling, PositionsAreThoseOfTheRow) {
  Row row = row_of({"a", 64, 50, 2, 1.0});
  row.id.parameters["bias"] = 0.5, row.id.parameters["zero"] = 0.0, row.id.receivers = 400;
  EXPECT_EQ(position_on("spheres", row), 64.0);
  EXPECT_EQ(position_on("threads", row), 2.0);
  EXPECT_EQ(position_on("receivers", row), 400.0);
  EXPECT_EQ(position_on("terms", row), 50.0);
  EXPECT_EQ(position_on("bias", row), 0.5);
  EXPECT_FALSE(position_on("zero", row)) << "0 has no logarithm";
  EXPECT_FALSE(position_on("mode", row)) << "a word";
  EXPECT_FALSE(position_on("unheard", row));
  row.id.reads_spheres = false;
  EXPECT_FALSE(position_on("spheres", row));
}

TEST(Scaling, CurvesHoldAllButOneQuantity) {
  const std::vector<Row> rows = rows_of({{"a", 64, 50, 1, 6.4},
                                         {"a", 32, 50, 1, 3.2},
                                         {"a", 128, 50, 1, 12.8},
                                         {"a", 64, 200, 1, 25},
                                         {"a", 64, 50, 2, 3.3},
                                         {"b", 32, 50, 1, 1}});
  const auto curves = scaling_curves(pointers(rows));
  ASSERT_EQ(curves.size(), 3u);
  const ScalingCurve& spheres = *over("spheres", curves);
  ASSERT_EQ(spheres.points.size(), 3u) << "of technique a at 50 terms on one thread";
  EXPECT_EQ(spheres.points[0].x, 32.0);
  EXPECT_EQ(spheres.points[0].y, 3.2);
  EXPECT_EQ(spheres.rows[2], &rows[2]);
  EXPECT_NEAR(log_log_slope(spheres.points).value->slope, 1.0, 1e-12);
  EXPECT_EQ(over("terms", curves)->points.size(), 2u);
  EXPECT_EQ(over("threads", curves)->rows[1], &rows[4]);
}

TEST(Scaling, CurvesLeaveOutWhatHasNoTimeAndWhatIsAlone) {
  std::vector<Row> rows = rows_of({{"a", 32, 0, 1, 1}, {"a", 64, 0, 1, 0}, {"a", 64, 0, 1, 2}, {"a", 64, 0, 1, 2}});
  rows[2].status = "failed: x";
  rows[3].id.objective = "cover";
  EXPECT_TRUE(scaling_curves(pointers(rows)).empty());
  EXPECT_TRUE(scaling_curves({}).empty());
}

TEST(Scaling, NoiseOfPointsIsThatOfRows) {
  std::vector<Row> rows = rows_of({{"a", 32, 0, 1, 1}, {"a", 64, 0, 1, 1}});
  rows[1].timing.frame_ms = {1, 2, 3, 4, 5};
  const auto curves = scaling_curves(pointers(rows));
  EXPECT_EQ(curves.at(0).points[1].y, 3.0);
  EXPECT_EQ(curves.at(0).points[1].noise, 1.0);
}

TEST(Scaling, ScenesAreAlikeButForDigits) {
  EXPECT_EQ(scene_stem("city-64x64"), "city-#x#");
  EXPECT_EQ(scene_stem("city-256x256"), "city-#x#");
  EXPECT_EQ(scene_stem("bunny"), "bunny");
  std::vector<Row> rows = rows_of({{"a", 8, 0, 1, 1, "city-16"},
                                   {"a", 8, 0, 1, 4, "city-32"},
                                   {"a", 8, 0, 1, 16, "city-64"},
                                   {"a", 8, 0, 1, 9, "town-32"},
                                   {"a", 9, 0, 1, 9, "city-32"}});
  const std::size_t receivers[] = {256, 1024, 4096, 1024, 1024};
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].id.receivers = receivers[k];
  const auto curves = receiver_curves(pointers(rows));
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_NEAR(log_log_slope(curves[0].points).value->slope, 1.0, 1e-12);
}

TEST(Scaling, TechniquesBreakEvenWhereTheirCurvesCross) {
  // 0.1 ms a sphere and 2 ms for the root of one: 400 spheres; rays take 20 ms for any number: 200.
  const std::vector<Row> rows = rows_of({{"table", 100, 0, 1, 10},
                                         {"table", 1600, 0, 1, 160},
                                         {"roots", 100, 0, 1, 20},
                                         {"roots", 1600, 0, 1, 80},
                                         {"rays", 0, 0, 1, 20},
                                         {"rays", 0, 0, 2, 20}});
  const auto curves = scaling_curves(pointers(rows));
  ASSERT_EQ(curves.size(), 3u) << "rays over threads are the third";
  const auto found = break_evens(curves, pointers(rows));
  ASSERT_EQ(found.size(), 2u) << "rays on two threads are compared with nothing, and roots only meet rays at their end";
  ASSERT_TRUE(found[0].second);
  EXPECT_NEAR(found[0].crossing.value->at, 400.0, 1e-9);
  EXPECT_TRUE(found[0].crossing.value->first_is_less_below);
  EXPECT_EQ(found[1].level, &rows[4]);
  EXPECT_NEAR(found[1].crossing.value->at, 200.0, 1e-9);
  EXPECT_TRUE(found[1].crossing.value->first_is_less_below);
}

TEST(Scaling, BreakEvenHoldsWhatBothHave) {
  const std::vector<Row> rows = rows_of({{"a", 10, 50, 1, 1},
                                         {"a", 1000, 50, 1, 100},
                                         {"b", 10, 50, 1, 2},
                                         {"b", 1000, 50, 1, 3},
                                         {"b", 10, 200, 1, 4},
                                         {"b", 1000, 200, 1, 5}});
  std::vector<ScalingCurve> curves = scaling_curves(pointers(rows));
  std::erase_if(curves, [](const ScalingCurve& curve) { return curve.axis != "spheres"; });
  ASSERT_EQ(curves.size(), 3u);
  const auto found = break_evens(curves, pointers(rows));
  ASSERT_EQ(found.size(), 1u) << "50 terms are not held against 200";
  EXPECT_EQ(found[0].second->rows[0], &rows[2]);
}

TEST(Scaling, ThreadsBreakEvenWithNothing) {
  const std::vector<Row> rows = rows_of({{"a", 8, 0, 1, 10}, {"a", 8, 0, 2, 2}, {"b", 8, 0, 1, 5}, {"b", 8, 0, 2, 4}});
  const auto curves = scaling_curves(pointers(rows));
  EXPECT_EQ(curves.size(), 2u);
  EXPECT_TRUE(break_evens(curves, pointers(rows)).empty());
}

}  // namespace
}  // namespace penumbra
