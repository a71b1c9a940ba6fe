// results.json: what is written, that it comes back to the bit, that old files are read, and that damage is said.
#include "harness/results/results_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "harness/results/row_json.h"
#include "tests/support.h"

namespace penumbra {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Row row_named(const std::string& technique, std::vector<double> ms) {
  Row row;
  row.id.scene = "s", row.id.technique = technique, row.id.backend = "simd";
  row.timing.update_ms = row.timing.shade_ms = row.timing.frame_ms = std::move(ms);
  row.timing.iterations = 3;
  row.score.errors["truth"].report.all.rel_rmse = 0.1;
  return row;
}

Row with_status(Row row, const std::string& status) {
  row.status = status;
  row.timing = {};
  return row;
}

class ResultsFile : public testing::Test {
 protected:
  void write(const std::vector<Row>& rows) const { write_results(folder_.path(), {{{"suite", "t"}}, rows}); }
  json file() const { return json::parse(test::read_text(path())); }
  void put(const std::string& text) const { std::ofstream(path()) << text; }
  std::string path() const { return folder_.path() + "/results.json"; }
  std::vector<Row> rows() const { return read_results_path(path()).rows; }
  std::string error() const {
    return test::error_of([&] { read_results_path(path()); });
  }
  const test::TemporaryFolder folder_;
};

/// Values of every size, as measuring makes them.
std::vector<double> random_numbers(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<double> exponent(-20.0, 20.0);
  std::vector<double> values(count);
  for (double& value : values) value = std::exp(exponent(random));
  return values;
}

TEST_F(ResultsFile, RowsComeBackToTheBitAndInOrder) {
  std::mt19937 random(7);
  std::vector<Row> rows;
  for (int k = 0; k < 50; ++k) {
    Row row = row_named("t" + std::to_string(k), random_numbers(random, std::size_t(1 + k % 5)));
    if (k % 2) row.timing.cpu_ms = random_numbers(random, row.timing.frame_ms.size());
    if (k % 3) row.timing.launch.assign(row.timing.frame_ms.size(), k);
    row.timing.update_ms = random_numbers(random, row.timing.frame_ms.size());
    row.timing.stages = {{"map", random_numbers(random, row.timing.frame_ms.size())}};
    row.id.parameters = {{"whole", 3}, {"number", 3.0}, {"small", 1e-300}, {"word", std::string("a \"b\" ü\n")}};
    row.id.defaults = {{"whole", 4}};
    row.score.errors["truth"].noise = random_numbers(random, 1)[0];
    row.score.parity = random_numbers(random, 1)[0];
    row.score.steps = {{"step", 0.1, 0.2}};
    row.score.sequence = SequenceErrors{{0.1, std::nullopt}, {}, {0.5}, 0.25, 1.5};
    row.facts.counters["clamped"] = std::size_t(1) << 62;
    if (k % 7 == 1) row = with_status(row, "failed: why");
    if (k % 7 == 2) row = with_status(row, "skipped: why");
    if (k % 7 == 3) row.timing = {}, row.id.backend = external_backend, row.id.threads = 0;
    rows.push_back(row);
  }
  write(rows);
  const std::vector<Row> back = this->rows();
  ASSERT_EQ(back.size(), rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(to_json(back[k]), to_json(rows[k]));
    EXPECT_EQ(back[k].timing.frame_ms, rows[k].timing.frame_ms);
    EXPECT_EQ(back[k].timing.update_ms, rows[k].timing.update_ms);
    EXPECT_EQ(back[k].timing.shade_ms, rows[k].timing.shade_ms);
    EXPECT_EQ(back[k].timing.cpu_ms, rows[k].timing.cpu_ms);
    EXPECT_EQ(back[k].timing.launch, rows[k].timing.launch);
    EXPECT_EQ(back[k].id.parameters, rows[k].id.parameters);
  }
  EXPECT_EQ(read_results(folder_.path()).context["suite"], "t");
}

TEST_F(ResultsFile, HasAnEntryForEveryRepetitionAndAggregatesAsGoogleBenchmarkDoes) {
  Row row = row_named("t", {2, 4, 9});
  row.timing.update_ms = {0.5, 0.25, 0}, row.id.threads = 4;
  write({with_status(row_named("other", {1}), "skipped: no"), row});
  const json entries = file()["benchmarks"];
  ASSERT_EQ(entries.size(), 7u);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(entries[k], json({{"name", row.id.name()},
                                {"run_name", row.id.name()},
                                {"family_index", 1},
                                {"per_family_instance_index", 0},
                                {"run_type", "iteration"},
                                {"repetitions", 3},
                                {"repetition_index", k},
                                {"threads", 4},
                                {"iterations", 3},
                                {"real_time", row.timing.frame_ms[k]},
                                {"cpu_time", row.timing.frame_ms[k]},
                                {"time_unit", "ms"},
                                {"update_ms", row.timing.update_ms[k]},
                                {"shade_ms", row.timing.shade_ms[k]}}));
  const double deviation = std::sqrt((9.0 + 1.0 + 16.0) / 2);
  const std::pair<const char*, double> aggregates[] = {
      {"mean", 5}, {"median", 4}, {"stddev", deviation}, {"cv", deviation / 5}};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto [name, value] = aggregates[k];
    EXPECT_EQ(entries[3 + k]["name"], row.id.name() + "_" + name);
    EXPECT_EQ(entries[3 + k]["run_name"], row.id.name());
    EXPECT_EQ(entries[3 + k]["run_type"], "aggregate");
    EXPECT_EQ(entries[3 + k]["aggregate_name"], name);
    EXPECT_EQ(entries[3 + k]["aggregate_unit"], k < 3 ? "time" : "percentage");
    EXPECT_EQ(entries[3 + k]["iterations"], 3);
    EXPECT_DOUBLE_EQ(entries[3 + k]["real_time"], value);
    EXPECT_EQ(entries[3 + k]["cpu_time"], entries[3 + k]["real_time"]);
  }
}

TEST_F(ResultsFile, OnlyRowsWithATimeAreInBenchmarks) {
  Row external = row_named("theirs", {});
  write({with_status(row_named("a", {}), "failed: f"), row_named("b", {2}),
         with_status(row_named("c", {}), "skipped: s"), external});
  const json file = this->file();
  ASSERT_EQ(file["benchmarks"].size(), 1u) << "one repetition has no aggregates";
  EXPECT_EQ(file["benchmarks"][0]["family_index"], 1);
  const std::pair<const char*, const char*> lists[] = {
      {"rows", "b"}, {"untimed", "theirs"}, {"failed", "a"}, {"skipped", "c"}};
  for (const auto& [list, technique] : lists) {
    ASSERT_EQ(file[list].size(), 1u) << list;
    EXPECT_EQ(file[list][0]["technique"], technique);
  }
  EXPECT_EQ(file["format_version"], 2);
}

TEST_F(ResultsFile, AFileOfAnOlderVersionIsRead) {
  Row row = row_named("old", {1, 2, 3});
  json entry = to_json(row);
  entry["run_type"] = "iteration", entry["real_time"] = 2, entry["time_unit"] = "ms";
  put(json{{"context", {{"suite", "t"}}}, {"benchmarks", {entry}}}.dump(1));
  ASSERT_EQ(rows().size(), 1u);
  EXPECT_EQ(to_json(rows()[0]), to_json(row));
}

TEST_F(ResultsFile, TimesThatAreNoneFailTheirRowAlone) {
  write({row_named("good", {1, 2}), row_named("bad", {1, 2, 3})});
  const auto read_with = [&](const json& value) {
    json changed = file();
    for (json& entry : changed["benchmarks"])
      if (entry["run_name"] == "s/spheres:0/bad/simd/threads:1" && entry.value("repetition_index", 0) == 1)
        entry["real_time"] = value;
    put(changed.dump());
    return rows();
  };
  for (const auto& [value, said] : std::vector<std::pair<json, std::string>>{
           {0, "repetition 1 took 0 ms"}, {-2.5, "repetition 1 took -2.5 ms"}, {nullptr, "repetition 1 took nan ms"}}) {
    const std::vector<Row> rows = read_with(value);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_TRUE(rows[0].ok());
    EXPECT_EQ(rows[1].status, "failed: its times cannot be used: " + said);
    EXPECT_FALSE(rows[1].timing.timed());
  }
  put("");
  write({row_named("zero", {1, 0}), row_named("nan", {1, std::nan("")})});
  EXPECT_TRUE(file()["benchmarks"].empty());
  EXPECT_EQ(file()["failed"].size(), 2u);
}

TEST_F(ResultsFile, DamageIsSaidWithTheFileAndWhatToDo) {
  write({row_named("a", {1, 2}), row_named("b", {1, 2})});
  const std::string good = test::read_text(path());
  for (std::size_t size = 0; size < good.size() - 3; size += 97) {
    put(good.substr(0, size));
    EXPECT_THAT(error(), HasSubstr(path() + ": not a results file")) << size;
    EXPECT_THAT(error(), HasSubstr("give the folder of a run")) << size;
  }
  const auto error_with = [&](const std::function<void(json&)>& change) {
    json file = json::parse(good);
    change(file);
    put(file.dump());
    return error();
  };
  EXPECT_THAT(error_with([](json& f) { f["rows"][1]["name"] = f["rows"][0]["name"]; }),
              HasSubstr("stands there twice"));
  EXPECT_THAT(error_with([](json& f) { f["rows"].erase(0); }), HasSubstr("which is no row"));
  EXPECT_THAT(error_with([](json& f) { f["benchmarks"].clear(); }),
              HasSubstr("no entry of 'benchmarks' has its times"));
  EXPECT_THAT(error_with([](json& f) { f["benchmarks"][0]["time_unit"] = "ns"; }),
              HasSubstr("'time_unit' is not 'ms'"));
  EXPECT_THAT(error_with([](json& f) { f["rows"][0].erase("errors"); }), HasSubstr("it has no field 'errors'"));
  EXPECT_THAT(error_with([](json& f) { f["rows"][0]["scene"] = 3; }), HasSubstr("its field 'scene' is not a word"));
  EXPECT_THAT(error_with([](json& f) { f["rows"][0] = 3; }), HasSubstr("row 0 of 'rows'"));
  EXPECT_THAT(error_with([](json& f) { f["format_version"] = 3; }), HasSubstr("another version of penumbra"));
  EXPECT_THAT(error_with([](json& f) { f["benchmarks"] = 1; }), HasSubstr("not a results file"));
  put("{\"context\": {}, \"benchmarks\": [{\"name\": \"BM_x\", \"run_name\": \"BM_x\", \"real_time\": 1}]}");
  EXPECT_THAT(error(), HasSubstr("row 0 of 'benchmarks', 'BM_x': it has no field 'scene'"));
  put("{\"context\": {}, \"benchmarks\": [NaN]}");
  EXPECT_THAT(error(), HasSubstr("column 32")) << "where it ceases to be JSON";
  put(std::string(100'000, '['));
  EXPECT_THAT(error(), HasSubstr("no JSON"));
}

TEST_F(ResultsFile, AMissingFileIsAnErrorUnlessARunBegins) {
  EXPECT_TRUE(read_results(folder_.path()).rows.empty());
  EXPECT_THAT(test::error_of([&] { read_results_path(folder_.path()); }), HasSubstr("results.json: no such file"));
  EXPECT_THAT(error(), HasSubstr("no such file"));
  write({row_named("a", {1})});
  EXPECT_EQ(read_results_path(folder_.path()).rows.size(), 1u) << "a folder";
  EXPECT_EQ(read_results_path(path()).rows.size(), 1u) << "a file";
}

TEST_F(ResultsFile, AFileThatNoRunWritesIsNotLoaded) {
  put("{");
  std::filesystem::resize_file(path(), std::uintmax_t(1) << 30);  // sparse
  EXPECT_THAT(error(), HasSubstr("its 1024 MiB are more than any run writes"));
}

RowIdentity identity_with(const Values& parameters, const Values& defaults) {
  RowIdentity id;
  id.scene = "s", id.technique = "t", id.backend = "simd", id.parameters = parameters, id.defaults = defaults;
  return id;
}

TEST(RowNames, HaveNoDefaultsAndSurviveANewParameter) {
  const RowIdentity id =
      identity_with({{"rays", 16}, {"mode", std::string("fast")}}, {{"rays", 8}, {"mode", std::string("fast")}});
  EXPECT_EQ(id.name(), "s/spheres:0/t/simd/rays:16/threads:1");
  EXPECT_EQ(id.full_name(), "s/spheres:0/t/simd/mode:fast/rays:16/threads:1");
  RowIdentity later = id;
  later.parameters["added"] = 0.5, later.defaults["added"] = 0.5;
  EXPECT_EQ(later.name(), id.name());
  EXPECT_NE(later.full_name(), id.full_name());
}

TEST(RowNames, AreShortUniqueAndStable) {
  const auto long_id = [](const std::string& last) {
    Values parameters;
    for (char letter = 'a'; letter < 'z'; ++letter) parameters[std::string(10, letter)] = std::string("ü");
    parameters["zz"] = last;
    return identity_with(parameters, {});
  };
  const std::string name = long_id("1").name();
  EXPECT_LE(name.size() + std::string("_median").size(), 200u);
  EXPECT_EQ(name, long_id("1").name());
  EXPECT_NE(name, long_id("2").name()) << "though they differ behind the end";
  EXPECT_EQ(name.substr(0, 40), long_id("2").name().substr(0, 40));
  EXPECT_NO_THROW(static_cast<void>(json(name).dump())) << "no letter is cut in two";
  EXPECT_EQ(name.substr(name.size() - 13), "~" + name.substr(name.size() - 12));
}

TEST(RowNames, AreFoundByWhatTheyAreCalledAndByAllParameters) {
  const RowIdentity id = identity_with({{"rays", 8}}, {{"rays", 8}});
  EXPECT_TRUE(is_in(Pattern("--filter", "simd/threads"), id));
  EXPECT_TRUE(is_in(Pattern("--filter", "simd/rays:8/threads"), id));
  EXPECT_FALSE(is_in(Pattern("--filter", "rays:16"), id));
}

}  // namespace
}  // namespace penumbra
