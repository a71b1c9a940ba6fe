#include "harness/measure/steps.h"

#include "harness/report/tables.h"
#include "harness/results/row_json.h"

#include "tests/support.h"

namespace penumbra {
namespace {

Image image_of(std::vector<float> values) {
  Image image{int(values.size()), 1, {}};
  for (const float v : values) image.pixels.emplace_back(v);
  return image;
}

TEST(Steps, SharesAddUpAndFollowTheHandComputation) {
  const Image rung = image_of({3, 4, 100}), own = image_of({3, 7, 0});
  const std::vector<bool> valid = {true, true, false};
  // First step: (1, 0); second: (-1, 3); whole: (0, 3).
  const auto steps = attribute_error({{"first", image_of({4, 4, 0}).pixels}, {"second", {}}}, rung, own, valid);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_NEAR(steps[0].rel_rmse, 1.0 / 5.0, 1e-6);
  EXPECT_NEAR(steps[0].share, 0.0, 1e-6);
  EXPECT_NEAR(steps[1].rel_rmse, std::sqrt(10.0) / 5.0, 1e-6);
  EXPECT_NEAR(steps[1].share, 1.0, 1e-6);
  EXPECT_EQ(steps[1].name, "second");
}

TEST(Steps, NothingToTellApart) {
  const std::vector<bool> valid = {true, true};
  EXPECT_TRUE(attribute_error({}, image_of({1, 1}), image_of({1, 1}), valid).empty());
  EXPECT_TRUE(attribute_error({{"a", {}}}, image_of({0, 0}), image_of({1, 1}), valid).empty()) << "black rung";
  const auto equal = attribute_error({{"a", {}}}, image_of({1, 1}), image_of({1, 1}), valid);
  EXPECT_EQ(equal[0].share, 0.0) << "no error, no 0 / 0";
}

TEST(Steps, RowsCarryStepsAndCountersThroughJson) {
  Row row;
  row.id.scene = "s", row.id.technique = "t", row.id.backend = "simd";
  row.score.steps = {{"light", 0.02, 0.25}, {"visibility", 0.03, 0.75}};
  row.facts.counters = {{"clamped", 7}, {"non_finite", 0}};
  const Row back = row_from_json(to_json(row).dump());
  EXPECT_EQ(to_json(back), to_json(row));
  EXPECT_EQ(back.score.steps[1].share, 0.75);
  EXPECT_NE(make_steps_table({row}).find("light 2 (25), visibility 3 (75)"), std::string::npos);
  EXPECT_NE(make_counters_table({row}).find("7 clamped\n"), std::string::npos);
  EXPECT_EQ(make_counters_table({row}).find("non_finite"), std::string::npos);
  EXPECT_EQ(make_steps_table({Row()}) + make_counters_table({Row()}), "");
}

}  // namespace
}  // namespace penumbra
