#include "harness/report/figures.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "harness/results/published_time.h"
#include "tests/harness/trade_rows.h"

namespace penumbra {
namespace {

using nlohmann::json;
using test::trade_row;
using testing::HasSubstr;

/// The one that has this value under this key.
json with(const json& all, const char* key, const json& value) {
  for (const json& one : all)
    if (one.at(key) == value) return one;
  return json();
}

/// Rays by their law (10 % at 1 ms), a technique four times as fast at 2 %, an image of another renderer.
Results some_results() {
  Results results;
  for (const auto& [ms, error, count] : {std::tuple(1.0, 0.1, 1), {25.0, 0.02, 25}, {100.0, 0.01, 100}}) {
    results.rows.push_back(trade_row("ray-traced", ms, error, 0.002));
    results.rows.back().id.parameters["rays"] = count;
  }
  results.rows.push_back(trade_row("mine", 6.25, 0.02, 0.002));
  results.rows.push_back(trade_row("theirs", 0, 0.05, 0.002));
  results.rows.back().id.backend = external_backend, results.rows.back().id.threads = 0;
  results.rows.push_back(trade_row("broken", 1, 0.001));
  results.rows.back().status = "failed: it is";
  return results;
}

TEST(Figures, OfASceneAreThoseOfTheirFunctions) {
  const Results results = some_results();
  const json figures = make_figures(results);
  EXPECT_EQ(figures["format_version"], 1);
  ASSERT_EQ(figures["scenes"].size(), 1u);
  const json& scene = figures["scenes"][0];
  const auto name = [&](std::size_t k) { return results.rows[k].id.name(); };
  EXPECT_EQ(scene["scene"], "s");
  EXPECT_EQ(scene["rows"], json({name(0), name(3), name(1), name(2), name(4)})) << "by time, those without one last";
  EXPECT_EQ(scene["truth_noise"], 0.002);
  EXPECT_NEAR(scene["floor"].get<double>(), 0.00282843, 1e-8);
  EXPECT_EQ(scene["pareto"], json({name(0), name(3), name(2)}));
  EXPECT_EQ(with(scene["cheapest"], "limit", 0.02)["row"], name(3));
  EXPECT_EQ(with(scene["cheapest"], "limit", 0.01)["row"], name(2));
  EXPECT_EQ(scene["ray_traced"], json({name(0), name(1), name(2)}));
  EXPECT_NEAR(with(scene["speed_up"], "row", name(3))["factor"].get<double>(), 4.0, 1e-9);
  EXPECT_THAT(with(scene["speed_up"], "row", name(4))["refused"], HasSubstr("no time"));
  EXPECT_EQ(scene["speed_up"].size(), 2u);
}

TEST(Figures, OfFamiliesReadTheirEnvelopes) {
  const json figures = make_figures(some_results());
  const json families = figures["scenes"][0]["families"];
  ASSERT_EQ(families.size(), 3u);
  const json rays = with(families, "technique", "ray-traced");
  EXPECT_NEAR(with(rays["time_at_error"], "error", 0.03)["ms"].get<double>(), 0.01 / 0.0009, 1e-9);
  EXPECT_NEAR(with(rays["error_at_time"], "ms", 1e3 / 60.0)["error"].get<double>(), 0.1 / std::sqrt(1e3 / 60.0), 1e-9);
  EXPECT_THAT(with(rays["error_at_time"], "ms", 0.1)["refused"], HasSubstr("below"));
  const json theirs = with(families, "technique", "theirs");
  EXPECT_TRUE(theirs["rows"].is_array() && theirs["rows"].empty());
  EXPECT_THAT(theirs["time_at_error"][0]["refused"], HasSubstr("no row has a time"));
}

TEST(Figures, OfScalingHaveASlopeOrSayWhyNot) {
  Results results = some_results();
  const json rays = with(make_figures(results)["scenes"][0]["scaling"], "axis", "rays");
  EXPECT_NEAR(rays["slope"].get<double>(), 1.0, 1e-12);
  EXPECT_EQ(rays["points"], json({{1.0, 1.0}, {25.0, 25.0}, {100.0, 100.0}}));
  EXPECT_EQ(rays["rows"].size(), 3u);
  EXPECT_EQ(rays["fixed"], "1 thread");
  results.rows.erase(results.rows.begin());
  EXPECT_THAT(with(make_figures(results)["scenes"][0]["scaling"], "axis", "rays")["refused"], HasSubstr("there are 2"));
}

TEST(Figures, OfBreakEvenNameBoth) {
  Results results;
  for (const auto& [technique, spheres, ms] :
       {std::tuple("table", 100, 10.0), {"table", 1600, 160.0}, {"roots", 100, 20.0}, {"roots", 1600, 80.0}}) {
    results.rows.push_back(trade_row(technique, ms, 0.02));
    results.rows.back().id.reads_spheres = true, results.rows.back().id.spheres = std::size_t(spheres);
  }
  const json found = make_figures(results)["scenes"][0]["break_even"];
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0]["at"].get<double>(), 400.0, 1e-9);
  EXPECT_EQ(found[0]["axis"], "spheres");
  EXPECT_EQ(found[0]["first"], "table simd (1 thread)");
  EXPECT_EQ(found[0]["second"], "roots simd (1 thread)");
  EXPECT_EQ(found[0]["faster_below"], "first");
}

TEST(Figures, WithoutARowOfTheReferenceThereIsNoSpeedUp) {
  const Results results = some_results();
  const json scene = make_figures(results, "other")["scenes"][0];
  EXPECT_TRUE(scene["ray_traced"].empty());
  EXPECT_THAT(with(scene["speed_up"], "row", results.rows[3].id.name())["refused"], HasSubstr("no row of other"));
  EXPECT_NEAR(with(make_figures(results, "mine")["scenes"][0]["speed_up"], "row", results.rows[1].id.name())["factor"]
                  .get<double>(),
              0.25, 1e-9);
}

TEST(Figures, OfNothingAreEmpty) {
  const json figures = make_figures({});
  EXPECT_TRUE(figures["scenes"].empty() && figures["published"].empty() && figures["receivers_scaling"].empty());
  Results failed;
  failed.rows = {trade_row("a", 1, 0.1)};
  failed.rows[0].status = "failed: x";
  const json scene = make_figures(failed)["scenes"][0];
  EXPECT_TRUE(scene["rows"].empty() && scene["pareto"].empty() && scene["scaling"].empty());
  EXPECT_TRUE(scene["truth_noise"].is_null() && scene["floor"].is_null());
  EXPECT_TRUE(scene["cheapest"][0]["row"].is_null());
}

TEST(Figures, SurviveWhatFilesMayHold) {
  Results results = some_results();
  results.rows[3].id.technique = "<script>\"\xff";
  results.rows[1].score.errors["truth"].report.all.rel_rmse = std::numeric_limits<double>::quiet_NaN();
  results.rows[2].score.errors.clear();
  results.context["published"] = "../../nowhere";
  const std::string text = make_figures(results).dump(-1, ' ', false, json::error_handler_t::replace);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_TRUE(json::parse(text)["published"].empty());
}

Row wavelet_row(int spheres, int terms, int level, double ms) {
  Row row = trade_row("wavelet", ms, 0.03);
  row.id.reads_spheres = true, row.id.spheres = std::size_t(spheres);
  row.id.parameters["terms"] = terms, row.id.parameters["level"] = level;
  return row;
}

TEST(Figures, HoldRowsAgainstPublishedFrameRates) {
  Results results;
  results.context["published"] = "zhao-che-2011-table2";
  results.rows = {wavelet_row(128, 200, 2, 1e3 / 128.0), wavelet_row(128, 200, 1, 1e3 / 200.0), trade_row("a", 1, 0.1)};
  const json all = make_figures(results)["published"];
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all[0]["title"], HasSubstr("Zhao & Che 2011"));
  EXPECT_EQ(all[0]["source"], "results/published/zhao-che-2011-table2.csv");
  EXPECT_EQ(all[0]["columns"], json({"terms", "spheres", "level", "device"}));
  EXPECT_EQ(all[0]["lines"].size(), 25u) << "24 figures, of which one has two rows";
  const json gpu = with(all[0]["lines"], "published", 12.8);
  EXPECT_EQ(gpu["keys"], json({{"terms", "200"}, {"spheres", "128"}, {"level", "2"}}));
  EXPECT_EQ(gpu["device"], "gpu-2");
  EXPECT_EQ(gpu["unit"], "fps");
  EXPECT_EQ(gpu["row"], results.rows[0].id.name());
  EXPECT_NEAR(gpu["here"].get<double>(), 128.0, 1e-9);
  EXPECT_NEAR(gpu["ratio"].get<double>(), 10.0, 1e-9);
  const json none = with(all[0]["lines"], "published", 2.91);
  EXPECT_TRUE(none["row"].is_null() && none["here"].is_null() && none["ratio"].is_null());
}

TEST(Figures, HoldStagesAgainstPublishedTimes) {
  Results results;
  results.context["published"] = "zhu-2019-tables";
  results.context["published_times"] = to_json({{"3", "scene a", "PCSS", "/slow/", {}},
                                                {"3", "scene a", "Fast PCSS", "/fast/", {"x", "y"}},
                                                {"3", "scene b", "PCSS", "/nothing/", {}}});
  results.rows = {trade_row("slow", 50, 0.1), trade_row("fast", 200, 0.1)};
  results.rows[1].timing.stages = {{"x", {1}}, {"y", {3}}, {"z", {100}}};
  const json all = make_figures(results)["published"];
  ASSERT_EQ(all.size(), 1u);
  const json& lines = all[0]["lines"];
  EXPECT_EQ(lines.size(), 16u) << "every figure of the file";
  EXPECT_EQ(lines[1]["keys"], json({{"table", "3"}, {"subject", "scene a"}, {"variant", "Fast PCSS"}}));
  EXPECT_EQ(lines[1]["here"], 4.0);
  EXPECT_NEAR(lines[1]["ratio"].get<double>(), 4.0 / 8.8, 1e-12);
  EXPECT_NEAR(lines[1]["published_relative"].get<double>(), 8.8 / 188.7, 1e-12);
  EXPECT_NEAR(lines[1]["here_relative"].get<double>(), 4.0 / 50.0, 1e-12);
  EXPECT_EQ(lines[1]["stages"], json({"x", "y"}));
  EXPECT_TRUE(with(lines, "published", 416.6)["row"].is_null()) << "asked for, and no row is there";
  EXPECT_EQ(with(lines, "published", 0.9866)["unit"], "1");
}

TEST(Figures, APublishedTableThatCannotBeReadIsLeftOut) {
  for (const json& times : {json("x"), json({{{"table", "9"}}}), to_json({{"9", "x", "y", "z", {}}}),
                            to_json({{"3", "scene a", "PCSS", "(", {}}})}) {
    Results results = some_results();
    results.context["published"] = "zhu-2019-tables", results.context["published_times"] = times;
    EXPECT_TRUE(make_figures(results)["published"].empty()) << times;
  }
}

}  // namespace
}  // namespace penumbra
