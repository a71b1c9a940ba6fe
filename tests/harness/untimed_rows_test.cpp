// Rows without a time: of images that were made elsewhere. Nowhere is that a time of 0.
#include <cmath>

#include "harness/report/tables.h"
#include "harness/results/derived.h"
#include "harness/results/row_json.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Row row_with(const std::string& technique, std::vector<double> ms, double error) {
  Row row;
  row.id.scene = "s", row.id.technique = technique, row.id.backend = ms.empty() ? external_backend : "simd";
  row.id.threads = ms.empty() ? 0 : 1;
  row.timing.frame_ms = row.timing.shade_ms = row.timing.update_ms = std::move(ms);
  Errors& e = row.score.errors["truth"].report.all;
  e.receivers = 5, e.rmse = error, e.rel_rmse = error;
  return row;
}

TEST(UntimedRows, TimesAreNullInJsonAndComeBackSo) {
  const Row row = row_with("theirs", {}, 0.1);
  const nlohmann::json json = to_json(row);
  for (const char* key :
       {"frame_ms", "prepare_ms", "update_ms", "shade_ms", "frame_spread_ms", "view_ms", "command_ms", "bytes"})
    EXPECT_TRUE(json.at(key).is_null()) << key << " " << json.at(key);
  EXPECT_EQ(to_json(row_from_json(json.dump())), json);
  EXPECT_TRUE(std::isnan(row.timing.median_frame_ms()));
  EXPECT_EQ(row.id.name(), "s/spheres:0/theirs/external");
  Row timed = row_with("ours", {2.0}, 0.1);
  timed.timing.command_ms = 99.0, timed.timing.prepare_ms = 0.0;
  EXPECT_EQ(to_json(timed)["command_ms"], 99.0);
  EXPECT_EQ(to_json(timed)["prepare_ms"], 0.0);
  EXPECT_EQ(row_from_json(to_json(timed).dump()).timing.command_ms, 99.0);
}

TEST(UntimedRows, AreNeitherFasterNorOptimalNorBeatAnother) {
  const Row exact = row_with("theirs", {}, 0.0), slow = row_with("slow", {9.0, 9.0}, 0.2),
            fast = row_with("fast", {1.0, 1.0}, 0.3);
  EXPECT_FALSE(faster(exact, slow));
  EXPECT_FALSE(faster(slow, exact));
  EXPECT_EQ(pareto_optimal({&exact, &slow, &fast}), (std::vector<bool>{false, true, true}));
}

TEST(UntimedRows, StandLastInTheTableWithEmptyTimes) {
  const std::string table = make_table({row_with("theirs", {}, 0.05), row_with("slow", {9.0}, 0.2)});
  const std::size_t slow = table.find("| slow |"), theirs = table.find("| theirs |");
  ASSERT_NE(theirs, std::string::npos);
  EXPECT_LT(slow, theirs);
  const std::string line = table.substr(theirs, table.find('\n', theirs) - theirs);
  EXPECT_EQ(line.find("0.0"), std::string::npos) << line;
  EXPECT_EQ(line.find("nan"), std::string::npos) << line;
  EXPECT_EQ(table.find("| P | theirs"), std::string::npos);
}

TEST(UntimedRows, CommandsHaveTheirWallTimeApart) {
  Row row = row_with("theirs", {}, 0.05);
  EXPECT_EQ(make_external_table({row}), "") << "an image that was scored had no command";
  row.timing.command_ms = 1234.5;
  EXPECT_NE(make_external_table({row}).find("| s | theirs | 1.234 | 0 |  |"), std::string::npos)
      << make_external_table({row});
  row.timing.frame_ms = {2.0, 4.0};
  EXPECT_NE(make_external_table({row}).find("| 2 | **3.000** ±0.5 |"), std::string::npos) << make_external_table({row});
}

TEST(UntimedRows, AreNotTheCheapest) {
  const std::string table = make_choice_table(
      {row_with("theirs", {}, 0.001), row_with("a", {1.0}, 0.02), row_with("b", {2.0}, 0.02), row_with("b", {}, 0.0)});
  EXPECT_EQ(table.find("theirs"), std::string::npos) << table;
  EXPECT_NE(table.find("| b | 2 ms"), std::string::npos) << table;
}

}  // namespace
}  // namespace penumbra
