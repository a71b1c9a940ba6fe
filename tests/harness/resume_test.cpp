// Runs that are resumed, interrupted, or in each other's way.
#include <fmt/format.h>

#include <set>

#include "tests/harness/runs.h"

namespace penumbra {
namespace {

using namespace test;

/// Edits the context of what is on disk.
void edit_context(const std::string& folder, const std::string& field, const nlohmann::json& value) {
  Results results = read_results(folder);
  results.context[field] = value;
  write_results(folder, results);
}

TEST_F(Runs, ResumeKeepsGoodRowsAndMeasuresTheRest) {
  run(suite_text({{"good", "scalar"}, {"throws", "scalar"}}));
  const auto before = row("good").timing.frame_ms;
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"unsupported", "scalar"}}), true), 0);
  EXPECT_EQ(row("good").timing.frame_ms, before);
  EXPECT_EQ(read_results(out()).rows.size(), 2u);
}

TEST_F(Runs, ResumeMeasuresAnewWhatFailedOrHasTooFewRepetitions) {
  const std::string suite = suite_text({{"good", "scalar"}});
  run(suite);
  for (const char* fault : {"short", "torn", "failed"}) {
    Results results = read_results(out());
    if (fault == std::string("short")) results.rows[0].timing.frame_ms.pop_back();
    else if (fault == std::string("torn")) results.rows[0].timing.update_ms.clear();
    else results.rows[0].status = "failed: once";
    write_results(out(), results);
    EXPECT_EQ(run(suite, true), 0);
    EXPECT_TRUE(row("good").ok()) << fault;
    EXPECT_EQ(row("good").timing.frame_ms.size(), 2u) << fault;
    EXPECT_EQ(row("good").timing.update_ms.size(), 2u) << fault;
  }
}

TEST_F(Runs, ResumeMeasuresAnewWhenTheSceneChanged) {
  run(suite_text({{"good", "scalar"}}));
  const std::string key = row("good").facts.scene_key;
  folder_.write("scene.toml",
                "name = \"tiny\"\n[occluder]\nmesh = \"sphere\"\n[receivers]\nplane = { half_extent = 1.0, resolution "
                "= 16, y = -1.0 }\n"
                "[light]\nenvironment = \"constant\"\n");
  run(suite_text({{"good", "scalar"}}), true);
  EXPECT_NE(row("good").facts.scene_key, key);
}

TEST_F(Runs, ResumeKeepsNoRowOfAnotherProgramOrMachine) {
  const std::string suite = suite_text({{"good", "scalar"}});
  run(suite);
  for (const auto& [field, value] : std::map<std::string, nlohmann::json>{{"commit", "0123"},
                                                                          {"dirty", "maybe"},
                                                                          {"cpu_name", "abacus"},
                                                                          {"flags", "-O0"},
                                                                          {"num_cpus", 999},
                                                                          {"program", ""}}) {
    const auto before = row("good").timing.frame_ms;
    edit_context(out(), field, value);
    testing::internal::CaptureStderr();
    EXPECT_EQ(run(suite, true), 0);
    testing::internal::GetCapturedStderr();
    EXPECT_NE(row("good").timing.frame_ms, before) << field << " differs, and the row was kept";
    const auto again = row("good").timing.frame_ms;
    EXPECT_EQ(run(suite, true), 0);
    EXPECT_EQ(row("good").timing.frame_ms, again) << "the new rows stand under the new context";
  }
}

TEST_F(Runs, ResumeKeepsNoRowOfOtherThreadsOrSettings) {
  const std::string suite = suite_text({{"good", "scalar"}});
  run(suite);
  Results results = read_results(out());
  const auto before = results.rows[0].timing.frame_ms;
  results.rows[0].id.threads = 7;
  write_results(out(), results);
  EXPECT_EQ(run(suite, true), 0);
  ASSERT_EQ(read_results(out()).rows.size(), 1u);
  EXPECT_EQ(row("good").id.threads, 1);
  EXPECT_NE(row("good").timing.frame_ms, before);
  const std::string key = row("good").facts.key;
  EXPECT_EQ(run("attribution = true\n" + suite, true), 0);
  EXPECT_NE(row("good").facts.key, key) << "a suite that asks for more measures again";
}

TEST_F(Runs, ResumeLeavesAloneWhatTheFilterLeavesOut) {
  const std::string suite = suite_text({{"good", "scalar"}, {"spy", "scalar"}});
  run(suite);
  const auto before = row("spy").timing.frame_ms;
  EXPECT_EQ(run(suite, true, "/good/"), 0);
  ASSERT_EQ(read_results(out()).rows.size(), 2u);
  EXPECT_EQ(row("spy").timing.frame_ms, before);
  EXPECT_NE(table_.find("| spy |"), std::string::npos) << "tables show what the file holds";
  folder_.write("scene.toml", scene_named("tiny", "environment = \"softbox\""));
  EXPECT_EQ(run(suite, true, "/good/"), 0);
  EXPECT_EQ(read_results(out()).rows.size(), 1u) << "but not what was measured on another scene";
}

TEST_F(Runs, ResumeMeasuresAnewWhenTheMotionChanged) {
  const auto moving = [&](int frames) {
    return folder_.write("moving.toml", scene_named("moving", constant) +
                                            fmt::format("[motion]\nkind = \"rigid\"\nframes = {}\n", frames));
  };
  EXPECT_EQ(run(suite_of({moving(3)})), 0);
  const std::string key = row("good").facts.key, scene = row("good").facts.scene_key;
  EXPECT_EQ(run(suite_of({moving(5)}), true), 0);
  EXPECT_EQ(row("good").facts.scene_key, scene) << "the scored frame is the same";
  EXPECT_NE(row("good").facts.key, key);
}

TEST_F(Runs, ResumedRowsOfABusyMachineStayMarked) {
  const std::string suite = suite_text({{"good", "scalar"}});
  run(suite);
  edit_context(out(), "busy", true);
  EXPECT_EQ(run(suite, true), 0);
  EXPECT_TRUE(read_results(out()).context["busy"]);
}

TEST_F(Runs, DamagedResultsAreWrongInput) {
  const std::string suite = suite_text({{"good", "scalar"}});
  std::filesystem::create_directories(out());
  for (const char* text : {"{", "[]", "{\"context\": null, \"benchmarks\": []}",
                           "{\"context\": {}, \"benchmarks\": null}", "{\"context\": {}, \"benchmarks\": [{}]}"}) {
    std::ofstream(out() + "/results.json") << text;
    EXPECT_NE(test::error_of([&] { run(suite, true); }).find("results.json: not a results file"), std::string::npos)
        << text;
    testing::internal::GetCapturedStdout();
  }
}

TEST_F(Runs, TwoRunsDoNotShareAFolder) {
  std::filesystem::create_directories(out());
  const ResultsFolder other(out());
  EXPECT_NE(test::error_of([&] {
              run(suite_text({{"good", "scalar"}}));
            }).find("another run is writing"),
            std::string::npos);
  testing::internal::GetCapturedStdout();
  EXPECT_FALSE(std::filesystem::exists(out() + "/results.json"));
}

TEST_F(Runs, InterruptsKeepWhatIsFinished) {
  std::vector<std::string> files;
  for (const char* name : {"a", "b", "c"})
    files.push_back(folder_.write(std::string(name) + ".toml", scene_named(name, constant)));
  registry_.add(fake("signals", Backend::scalar, "signals"));
  const std::string suite = suite_of(files, "signals");
  Fake::signals_at = 2;  // while the second scene is prepared
  EXPECT_EQ(run(suite), 130);
  ASSERT_EQ(read_results(out()).rows.size(), 1u);
  EXPECT_EQ(read_results(out()).rows[0].id.scene, "a");
  const auto kept = read_results(out()).rows[0].timing.frame_ms;
  EXPECT_EQ(run(suite, true), 0);
  ASSERT_EQ(read_results(out()).rows.size(), 3u);
  EXPECT_EQ(read_results(out()).rows[0].timing.frame_ms, kept);
}

TEST_F(Runs, AResumedRunKeepsWhatItHasNotReachedOnDisk) {
  std::vector<std::string> files;
  for (const char* name : {"a", "b", "c"})
    files.push_back(folder_.write(std::string(name) + ".toml", scene_named(name, constant)));
  EXPECT_EQ(run(suite_of(files, "spy")), 0);
  folder_.write("b.toml", scene_named("b", "environment = \"softbox\""));
  Fake::watched = out() + "/results.json";
  EXPECT_EQ(run(suite_of(files, "spy"), true), 0);
  std::set<std::string> on_disk;  // while b was measured
  const auto file = nlohmann::json::parse(Fake::seen);
  for (const char* list : {"rows", "untimed", "failed", "skipped"})
    for (const auto& saved : file[list]) on_disk.insert(saved["scene"]);
  EXPECT_TRUE(on_disk.contains("a")) << "finished";
  EXPECT_TRUE(on_disk.contains("c")) << "not reached";
  EXPECT_EQ(read_results(out()).rows.size(), 3u);
}

}  // namespace
}  // namespace penumbra
