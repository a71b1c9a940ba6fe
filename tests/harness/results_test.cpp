#include "harness/catalogue/catalogue.h"
#include "harness/measure/timing.h"
#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/tables.h"
#include "harness/results/derived.h"
#include "harness/results/provenance.h"
#include "harness/results/results_folder.h"
#include "harness/results/row_json.h"
#include "harness/results/statistics.h"

#include "tests/support.h"

namespace penumbra {
namespace {

Row row_with(const std::string& technique, double ms, double error, double noise = 0.0) {
  Row row;
  row.id.scene = "s";
  row.id.technique = technique;
  row.id.backend = "simd";
  row.id.parameters["rays"] = 16;
  row.id.parameters["width"] = 0.5;
  row.id.parameters["mode"] = std::string("fast");
  row.timing.frame_ms = {ms, ms + 1, ms - 1};
  row.timing.update_ms = {0.5, 0.5, 0.5};
  row.timing.shade_ms = {ms - 0.5, ms + 0.5, ms - 1.5};
  row.timing.iterations = 7;
  row.timing.prepare_ms = 0.0;
  row.timing.stages = {{"map", {1, 3, 2}}, {"filter", {4, 4, 5}}};
  row.timing.view_ms = 12.5;
  row.facts.bytes = {1, 2, 3};
  row.score.errors["truth"].report.all.receivers = 5;
  row.score.errors["truth"].report.all.rmse = error;
  row.score.errors["truth"].report.all.rel_rmse = error;
  row.score.errors["truth"].report.all.ssim = 0.9;
  row.score.errors["truth"].report.region[1].receivers = 5;
  row.score.errors["truth"].rel_noise = noise;
  return row;
}

TEST(Results, RowsRoundTripThroughJson) {
  const Row row = row_with("a", 10, 0.1, 0.01);
  const Row back = row_from_json(to_json(row).dump());
  EXPECT_EQ(to_json(back), to_json(row));
  EXPECT_EQ(back.id.name(), row.id.name());
  EXPECT_EQ(back.id.parameters, row.id.parameters);
}

TEST(Results, RowsHaveTheAgreedFields) {
  const auto json = to_json(row_with("a", 10, 0.1));
  for (const char* key : {"technique", "backend", "scene", "parameters", "prepare_ms", "update_ms", "shade_ms",
                          "frame_ms", "bytes", "errors", "status", "name", "iterations", "repetitions", "samples"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* key : {"rmse", "rel_rmse", "psnr", "ssim", "flip", "max", "mean_signed", "noise", "regions"})
    EXPECT_TRUE(json["errors"]["truth"].contains(key)) << key;
  EXPECT_EQ(json["frame_ms"], 10);
  EXPECT_EQ(json["bytes"], 6);
}

TEST(Results, StagesKeepTheirOrderAndAddUp) {
  const Row row = row_with("a", 10, 0.1);
  const auto json = to_json(row);
  EXPECT_EQ(json["stages"][0]["name"], "map");
  EXPECT_EQ(json["stages"][1]["ms"], 4);
  EXPECT_EQ(row.timing.stages_ms({"filter", "map"}), 6);
  EXPECT_TRUE(std::isnan(row.timing.stages_ms({"map", "blur"}))) << "a stage that is not there is not 0 ms";
  const std::string text = make_stages_table({row});
  EXPECT_NE(text.find("| view | frame | map | filter |"), std::string::npos) << text;
  EXPECT_NE(text.find("| 12.50 | 10.00 | 2.00 | 4.00 |"), std::string::npos) << text;
  Row none = row;
  none.timing.stages.clear();
  EXPECT_EQ(make_stages_table({none}), "");
}

TEST(Results, ChoiceNamesTheCheapestWithinAnError) {
  const std::string text = make_choice_table({row_with("a", 10, 0.02), row_with("a", 30, 0.009),
                                              row_with("a", 40, 0.001), row_with("b", 5, 0.05), row_with("c", 1, 0.5)});
  EXPECT_NE(text.find("| a | **30 ms**, 0.9 %, simd | **10 ms**, 2 %, simd | 10 ms, 2 %, simd |"), std::string::npos)
      << text;
  EXPECT_NE(text.find("| b | | | **5 ms**, 5 %, simd |"), std::string::npos) << text;
  EXPECT_EQ(text.find("| c |"), std::string::npos) << "within no limit: " << text;
  EXPECT_EQ(make_choice_table({row_with("a", 10, 0.02)}), "") << "nothing to choose";
}

// Rows of 10 to 11 ms with a spread of 0.5 are equally fast; of them the nearest counts, and none of them is beaten.
TEST(Results, ChoiceHonoursTheNoiseOfTimes) {
  const std::string text =
      make_choice_table({row_with("a", 10, 0.028), row_with("a", 10.9, 0.011), row_with("a", 12, 0.0105),
                         row_with("b", 10.5, 0.02), row_with("c", 13, 0.001)});
  EXPECT_NE(text.find("| a | | **10.9 ms**, 1.1 %, simd |"), std::string::npos) << text;
  EXPECT_NE(text.find("| b | | **10.5 ms**, 2 %, simd |"), std::string::npos) << text;
  EXPECT_NE(text.find("| c | **13 ms**, 0.1 %, simd | 13 ms, 0.1 %, simd |"), std::string::npos) << text;
  EXPECT_NE(make_choice_table({row_with("a", 10, 0.2), row_with("b", 10, 0.3)}).find("None is within 10 %"),
            std::string::npos);
}

TEST(Results, OneTableAScene) {
  Row fast = row_with("fast", 10, 0.2), near = row_with("near", 20, 0.1), exact = row_with("exact", 30, 0.001, 0.01),
      as_exact = row_with("as-exact", 40, 0.002, 0.01);
  const std::string text = make_table({exact, near, fast, as_exact});
  EXPECT_EQ(text.find("by error"), std::string::npos);
  EXPECT_LT(text.find("| fast |"), text.find("| near |")) << "in order of time";
  EXPECT_NE(text.find("| truth % | rank | signed |"), std::string::npos)
      << "cube, spheres, geometry and 13x13 are left out: " << text;
  for (const char* part : {"| 20 | 4 |", "| 10 | 3 |", "(tie) | 1 |"})
    EXPECT_NE(text.find(part), std::string::npos) << part << text;
  EXPECT_EQ(text.find("(tie) | 2 |"), std::string::npos) << "ties share their rank";
  EXPECT_EQ(text.find("negative |"), std::string::npos);
  fast.score.errors["truth"].report.all.negative = 3;
  EXPECT_NE(make_table({fast, near}).find("| negative |"), std::string::npos);
}

TEST(Results, EveryReasonIsSaidOnce) {
  Row a = row_with("a", 1, 0.1), b = row_with("b", 1, 0.1), c = row_with("c", 1, 0.1);
  a.status = b.status = "skipped: why", c.status = "failed: so";
  EXPECT_TRUE(make_table({a, c, b}).ends_with("\n## s: not measured\n\n- a, b: skipped: why\n- c: failed: so\n"))
      << make_table({a, c, b});
}

TEST(Results, LabelsSayWhatTellsRowsApart) {
  Row a = row_with("a", 1, 0.1), b = a;
  a.id.defaults = b.id.defaults = a.id.parameters;
  EXPECT_EQ(short_label(a, {&a, &b}), "a");
  b.id.parameters["rays"] = 64;
  EXPECT_EQ(short_label(b, {&a, &b}), "a rays=64");
  b.id.backend = "scalar", b.id.threads = 7;
  EXPECT_EQ(short_label(b, {&a, &b}), "a scalar rays=64") << "another backend has other threads anyway";
  b.id.backend = "simd";
  EXPECT_EQ(short_label(b, {&a, &b}), "a rays=64 threads=7");
  b.id.spheres = 8, b.id.objective = "cover";
  EXPECT_EQ(short_label(b, {&a, &b}), "a rays=64 threads=7 spheres=8 cover");
  EXPECT_EQ(variant_label(b, {&a, &b}), "a rays=64 threads=7");
  Row other = b;
  other.id.technique = "b";
  EXPECT_EQ(short_label(b, {&b, &other}), "a rays=64") << "what another technique has says nothing";
}

TEST(Results, TheHeadingSaysWhatWasMeasuredWhereAndWhen) {
  nlohmann::json context = {{"suite", "quick"},     {"cpu_name", "Abacus 9"},       {"num_cpus", 2},
                            {"date", "2026-01-02"}, {"commit", "0123456789abcdef"}, {"dirty", "false"},
                            {"compiler", "GNU 12"}, {"build_type", "Release"},      {"busy", false}};
  const Row row = row_with("a", 1, 0.1);
  EXPECT_EQ(make_heading(context, {row}),
            "# quick\n\n- machine: Abacus 9, 2 cores\n- date: 2026-01-02\n- commit: 0123456789, GNU 12, Release\n"
            "- measured: 3 repetitions\n");
  context["dirty"] = "true", context["busy"] = true;
  Row once = row_with("b", 1, 0.1);
  once.timing.frame_ms = {1.0};
  const std::string text = make_heading(context, {row, once});
  for (const char* part : {"0123456789 with changes that are not committed", "it was busy", "1 to 3 repetitions"})
    EXPECT_NE(text.find(part), std::string::npos) << part << text;
  EXPECT_EQ(make_heading(nlohmann::json::object(), {}), "# penumbra\n\n- measured: nothing was measured\n");
}

TEST(Results, MarkdownTablesLeaveOutWhatIsEmpty) {
  MarkdownTable table({"", "name", "nothing", "figure"});
  EXPECT_EQ(table.text(), "");
  table.add({"P", "a|b", "", "1"});
  table.add({"", "c\nd", "", ""});
  EXPECT_EQ(table.text(), "| | name | figure |\n|---|---|---|\n| P | a\\|b | 1 |\n| | c d | |\n");
}

TEST(Results, MedianIsTheMiddle) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(median({}), 0);
}

TEST(Results, ParetoRowsAreNotBeaten) {
  Row failed = row_with("f", 0.1, 0.0);
  failed.status = "failed: x";
  const std::vector<Row> rows = {row_with("fast", 2, 0.5), row_with("good", 20, 0.1), row_with("beaten", 21, 0.2),
                                 failed};
  EXPECT_EQ(pareto_optimal({&rows[0], &rows[1], &rows[2], &rows[3]}), (std::vector<bool>{true, true, false, false}));
}

TEST(Results, DifferencesBelowTheNoiseAreTies) {
  const Row slow = row_with("slow", 20, 0.001, 0.01), fast = row_with("fast", 2, 0.009, 0.01);
  EXPECT_EQ(pareto_optimal({&slow, &fast}), (std::vector<bool>{false, true}));
  EXPECT_NE(make_table({slow, fast}).find("(tie)"), std::string::npos);
}

/// As on a black truth: an error, but nothing that it is relative to.
Row undefined_row(const std::string& technique, double ms, double rmse) {
  Row row = row_with(technique, ms, 0.0);
  Errors& all = row.score.errors["truth"].report.all;
  all = {};
  all.receivers = 576, all.rmse = rmse;
  row.score.errors["truth"].rel_noise.reset();
  row.score.errors["cube"] = row.score.errors["spheres"] = row.score.errors["truth"];
  return row;
}

TEST(Results, UndefinedErrorsAreNeitherZeroNorBest) {
  const Row fast = undefined_row("fast", 1, 0.0027), slow = undefined_row("slow", 2, 0.0);
  EXPECT_FALSE(fast.score.truth_error());
  EXPECT_EQ(pareto_optimal({&fast, &slow}), (std::vector<bool>{false, false}));
  const std::string text = make_table({fast, slow});
  EXPECT_NE(text.find("undefined (RMSE 0.0027) | 2 | undefined (RMSE 0.0027) | undefined (RMSE 0.0027) | undefined |"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("The truth is black"), std::string::npos);
  for (const char* wrong : {"| P |", "| 0 |  |", "(tie) |", "inf", "nan"})
    EXPECT_EQ(text.find(wrong), std::string::npos) << wrong;
  EXPECT_NE(text.find("undefined (RMSE 0) | 1 |"), std::string::npos) << "ranked by RMSE";
  const std::string choice = make_choice_table({fast, slow});
  EXPECT_NE(choice.find("the truth is black"), std::string::npos) << choice;
  EXPECT_EQ(choice.find(" ms"), std::string::npos) << choice;
  EXPECT_NE(make_baseline_table("cube", {fast}).find("| undefined |"), std::string::npos);
  Row with_steps = fast;
  with_steps.score.steps = {{"light", 0.02, 1.0}};
  EXPECT_NE(make_steps_table({with_steps}).find("| undefined | light 2 (100) | undefined | undefined (RMSE 0.0027) |"),
            std::string::npos);
}

TEST(Results, AnExactImageIsATieAndOneThatIsWorseIsNot) {
  // An exact image differs from a truth of noise s by s, not by less.
  for (const double ratio : {0.5, 1.0, 1.4})
    EXPECT_TRUE(row_with("a", 1, 0.01 * ratio, 0.01).score.errors["truth"].tie());
  EXPECT_FALSE(row_with("a", 1, 0.0143, 0.01).score.errors["truth"].tie());
  EXPECT_FALSE(row_with("a", 1, 0.0, 0.0).score.errors["truth"].tie()) << "without noise there is nothing to hide in";
  EXPECT_NEAR(row_with("a", 1, 0.0, 0.01).score.errors["truth"].floor(), 0.0141421, 1e-7);
  SequenceErrors sequence;
  sequence.rel_noise = 0.01;
  EXPECT_NEAR(sequence.floor(), 0.0141421, 1e-7);
  EXPECT_NEAR(sequence.flicker_floor(), 0.02, 1e-9) << "two frames' noise is in a difference";
  EXPECT_TRUE(to_json(row_with("a", 1, 0.012, 0.01))["errors"]["truth"]["tie"]);
}

TEST(Results, SpreadIsHalfTheInterquartileRange) {
  EXPECT_EQ(spread({1, 2, 3, 4, 100}), 1.0);
  EXPECT_EQ(spread({5, 1, 3}), 1.0);
  EXPECT_EQ(spread({7}), 0.0);
  EXPECT_EQ(spread({}), 0.0);
  Row row = row_with("a", 10, 0.1);
  Row once = row;
  once.timing.frame_ms = {10};
  EXPECT_NE(make_table({once}).find("**10.000** |"), std::string::npos) << "one sample has no spread";
  EXPECT_NE(make_table({row}).find("**10.000** ±0.5 |"), std::string::npos) << make_table({row});
  EXPECT_EQ(to_json(row)["frame_spread_ms"], 0.5);
}

TEST(Results, TimesWithinTheirNoiseAreTies) {
  const Row fast = row_with("fast", 10, 0.2), slow = row_with("slow", 10.9, 0.1),
            slower = row_with("slower", 11.1, 0.1);
  EXPECT_FALSE(faster(fast, slow)) << "9.5 to 10.5 and 10.4 to 11.4 overlap";
  EXPECT_TRUE(faster(fast, slower));
  EXPECT_FALSE(faster(slower, fast));
  EXPECT_EQ(pareto_optimal({&fast, &slow}), (std::vector<bool>{false, true})) << "as fast, and nearer";
  EXPECT_EQ(pareto_optimal({&fast, &slower}), (std::vector<bool>{true, true}));
}

TEST(Results, ParametersThatAreNotTheDefaultAreShown) {
  Row row = row_with("a", 1, 0.1);
  row.id.defaults = row.id.parameters;
  EXPECT_EQ(telling_parameters(row, {&row}), "");
  row.id.defaults["width"] = 0.25;
  EXPECT_EQ(telling_parameters(row, {&row}), "width=0.5") << "though no other row has another width";
  Row other = row;
  other.id.parameters["rays"] = 64;
  EXPECT_EQ(telling_parameters(row, {&row, &other}), "rays=16 width=0.5");
  other.id.technique = "b";
  EXPECT_EQ(telling_parameters(row, {&row, &other}), "width=0.5");
}

TEST(Results, SpheresThatDoNotMatterAreNotShown) {
  Row row = row_with("a", 1, 0.1);
  row.id.spheres = 77, row.id.objective = "cover";
  EXPECT_NE(make_table({row}).find("| 77 cover |"), std::string::npos);
  row.id.reads_spheres = false;
  EXPECT_EQ(make_table({row}).find("77 cover"), std::string::npos);
}

TEST(Results, MergingReplacesByNameAndIsAssociative) {
  const std::vector<Row> a = {row_with("x", 1, 0.1), row_with("y", 2, 0.1)}, b = {row_with("y", 3, 0.1)},
                         c = {row_with("z", 4, 0.1), row_with("x", 5, 0.1)};
  const auto text = [](const std::vector<Row>& rows) {
    std::string all;
    for (const Row& row : rows) all += to_json(row).dump();
    return all;
  };
  EXPECT_EQ(text(merged(merged(a, b), c)), text(merged(a, merged(b, c))));
  const std::vector<Row> all = merged(merged(a, b), c);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].timing.frame_ms[0], 5) << "the later one";
  EXPECT_EQ(all[1].timing.frame_ms[0], 3);
}

TEST(Provenance, RowsOfAnotherProgramOrMachineDoNotMix) {
  const nlohmann::json now = machine_context(make_registry());
  nlohmann::json then = now;
  then["load_avg"] = {9.0}, then["date"] = "yesterday";
  EXPECT_EQ(difference(then, now), "") << "these may differ";
  for (const char* field : {"commit", "dirty", "program", "cpu_name", "num_cpus", "instruction_sets", "compiler",
                            "flags", "build_type", "cuda"}) {
    nlohmann::json other = now;
    other[field] = "else";
    EXPECT_NE(difference(other, now).find(std::string(field) + " else then"), std::string::npos) << field;
    other.erase(field);
    EXPECT_NE(difference(other, now), "") << field << " is missing";
  }
}

TEST(ResultsFolder, KeepsRowsInOrderAndOneWriter) {
  const test::TemporaryFolder place;
  const std::string path = place.path() + "/out";
  ResultsFolder folder(path);
  EXPECT_NE(test::error_of([&] { ResultsFolder second(path); }).find("another run is writing"), std::string::npos);
  folder.begin({{"suite", "s"}}, {row_with("old", 1, 0.1), row_with("b", 1, 0.1)});
  folder.expect({row_with("a", 1, 0.1).id.name(), row_with("b", 1, 0.1).id.name()});
  folder.add(row_with("b", 7, 0.1));
  folder.add(row_with("a", 8, 0.1));
  ASSERT_EQ(folder.rows().size(), 2u);
  EXPECT_EQ(folder.rows()[0].id.technique, "a") << "as expected, not as finished";
  EXPECT_EQ(folder.save(), "");
  EXPECT_EQ(read_results(path).rows.size(), 3u) << "what waits is still there";
  EXPECT_EQ(folder.all_rows().size(), 3u);
  const Results saved = read_results(path);
  EXPECT_EQ(saved.rows[1].timing.frame_ms[0], 7) << "the new one, not the one that waited";
  EXPECT_EQ(saved.rows[2].id.technique, "old");
  folder.add(row_with("old", 9, 0.1));
  folder.expect({row_with("old", 1, 0.1).id.name()});
  EXPECT_EQ(folder.save(), "");
  ASSERT_EQ(read_results(path).rows.size(), 3u);
  EXPECT_EQ(read_results(path).rows[2].timing.frame_ms[0], 9);
  EXPECT_EQ(saved.context["suite"], "s");
}

TEST(Results, UndefinedRowsNeitherBeatNorAreBeaten) {
  const Row dark = undefined_row("dark", 1, 0.0), lit = row_with("lit", 2, 0.1);
  EXPECT_EQ(pareto_optimal({&dark, &lit}), (std::vector<bool>{false, true}));
  EXPECT_EQ(make_choice_table({dark, lit}).find("dark | 1"), std::string::npos);
}

TEST(Results, UndefinedErrorsAreNullInJsonAndReadBack) {
  const Row row = undefined_row("a", 1, 0.0027);
  const nlohmann::json json = nlohmann::json::parse(to_json(row).dump());
  const nlohmann::json& truth = json["errors"]["truth"];
  for (const char* key : {"rel_rmse", "psnr", "rel_noise"}) EXPECT_TRUE(truth[key].is_null()) << key;
  EXPECT_EQ(truth["rmse"], 0.0027);
  for (const char* key : {"rmse", "rel_rmse", "max", "mean_signed", "psnr"})
    EXPECT_TRUE(truth["regions"]["umbra"][key].is_null()) << key << ": there is no receiver in the umbra";
  EXPECT_TRUE(json["geometry_rel_rmse"].is_null());
  const Row back = row_from_json(json.dump());
  EXPECT_EQ(to_json(back), to_json(row));
  EXPECT_FALSE(back.score.truth_error() || back.score.geometry || back.score.errors.at("truth").report.all.psnr);
  Row equal = row_with("b", 1, 0.0);
  equal.score.errors["truth"].report.all.psnr = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isinf(*row_from_json(to_json(equal).dump()).score.errors.at("truth").report.all.psnr));
}

TEST(Results, AStatusThatIsNoUtf8IsWritten) {
  const test::TemporaryFolder folder;
  Row row = row_with("a", 1, 0.1);
  row.status = "failed: \xff.exr: no such image file";
  write_results(folder.path(), {machine_context(make_registry()), {row}});
  EXPECT_TRUE(read_results(folder.path()).rows[0].status.ends_with(".exr: no such image file"));
}

TEST(Results, FilesAreReadBackAndDamageIsNoticed) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(read_results(folder.path()).rows.empty());
  write_results(folder.path(), {machine_context(make_registry()), {row_with("a", 1, 0.1), row_with("b", 2, 0.2)}});
  EXPECT_EQ(read_results(folder.path()).rows.size(), 2u);
  folder.write("results.json", "{");
  EXPECT_NE(test::error_of([&] { read_results(folder.path()); }).find("results.json"), std::string::npos);
}

TEST(Results, ContextSaysWhatWasMeasured) {
  const auto context = machine_context(make_registry());
  for (const char* key : {"cpu_name", "num_cpus", "caches", "instruction_sets", "compiler", "flags", "commit", "dirty",
                          "load_avg", "date", "program", "busy"})
    EXPECT_TRUE(context.contains(key)) << key;
  EXPECT_FALSE(context.contains("host_name"));
}

}  // namespace
}  // namespace penumbra
