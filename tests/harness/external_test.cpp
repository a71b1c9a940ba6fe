// Techniques that live in other programs, and what these may do wrong.
#include "harness/measure/external.h"

#include <fmt/format.h>

#include <chrono>

#include "harness/measure/child_process.h"
#include "harness/measure/foreign_image.h"
#include "harness/results/row_json.h"
#include "tests/harness/runs.h"

namespace penumbra {
namespace {

using namespace test;

class Externals : public Runs {
 protected:
  Externals() {
    save_exr(folder_.path() + "/right.exr", {16, 16, std::vector<vec3>(256, vec3(1.0f))});
    save_exr(folder_.path() + "/small.exr", {8, 8, std::vector<vec3>(64, vec3(1.0f))});
  }
  std::string external(const std::string& name, const std::string& command, const std::string& more = "") const {
    return "[[external]]\nname = \"" + name + "\"\ncommand = '''" + command + "'''\n" + more;
  }
  /// Runs one external technique beside a good one, and returns its row.
  Row row_of(const std::string& command, const std::string& more = "", bool resume = false) {
    code_ = run(suite_text({{"good", "scalar"}}) + external("mine", command, more), resume);
    EXPECT_TRUE(row("good").ok()) << "the run goes on";
    return row("mine", "external");
  }
  void expect_failure(const std::string& command, const std::string& why, const std::string& more = "") {
    const Row failed = row_of(command, more);
    EXPECT_TRUE(failed.status.starts_with("failed: ")) << command << ": " << failed.status;
    EXPECT_NE(failed.status.find(why), std::string::npos) << failed.status;
    EXPECT_EQ(failed.status.find('\n'), std::string::npos) << failed.status;
    EXPECT_EQ(code_, 1) << command;
  }
  int code_ = 0;
};

TEST_F(Externals, AnImageFromElsewhereIsScoredLikeOneOfOurs) {
  const Row mine = row_of("test -s {scene}/scene.json && test -s {scene}/mesh.ply && cp right.exr {out}");
  EXPECT_EQ(mine.status, "ok");
  EXPECT_EQ(code_, 0);
  EXPECT_EQ(to_json(mine)["errors"], to_json(row("good"))["errors"]) << "to the bit: both are 1 everywhere";
  EXPECT_GT(mine.timing.command_ms, 0.1);
  EXPECT_FALSE(mine.timing.timed());
  EXPECT_EQ(mine.id.name(), "tiny/spheres:0/mine/external");
  EXPECT_TRUE(std::filesystem::exists(out() + "/images/tiny-0-spheres/mine-external.error.exr"));
  EXPECT_TRUE(std::filesystem::exists(out() + "/images/tiny-0-spheres/mine-external.png"));
  EXPECT_NE(table_.find("mine"), std::string::npos);
}

TEST_F(Externals, PrintedTimesAreSamples) {
  const Row mine = row_of(
      "echo hello; echo time_ms: 2.5; yes | head -c 9000000; printf '\\n time_ms:  4e0\\r\\n'; "
      "cp right.exr {out}; printf 'time_ms: 3'");
  EXPECT_EQ(mine.timing.frame_ms, (std::vector<double>{2.5, 4.0, 3.0}));
  EXPECT_EQ(mine.timing.median_frame_ms(), 3.0);
  EXPECT_TRUE(mine.timing.update_ms.empty());
  EXPECT_GT(mine.timing.command_ms, 0.0) << "apart";
}

TEST_F(Externals, WhatGoesWrongIsTheReasonOfTheRow) {
  expect_failure("echo first >&2; echo 'no  licence' >&2; echo >&2; exit 3 # {out}", "exit code 3: no  licence");
  expect_failure("no-such-program {out}", "exit code 127");
  expect_failure("kill -SEGV $$ # {out}", "crashed (signal 11");
  expect_failure("true {out}", "wrote no image");
  expect_failure("echo text > {out}", "failed: {out}: cannot be read as an image");
  expect_failure("mkdir {out}", "failed: {out}: is a folder");
  expect_failure("cp small.exr {out}", "is 8 x 8 pixels, and scene 'tiny' has 16 x 16 receivers");
  expect_failure("cp right.exr {out}; echo time_ms: fast", "printed 'time_ms: fast'");
  expect_failure("cp right.exr {out}; echo time_ms: 0", "a positive number");
  expect_failure("cp right.exr {out}; echo time_ms: 1 ms", "a positive number");
}

TEST_F(Externals, WhatHangsIsKilledWithItsChildren) {
  const auto start = std::chrono::steady_clock::now();
  expect_failure("(sleep 77; touch late) & sleep 77; cp right.exr {out}", "did not end within", "timeout_s = 0.3\n");
  EXPECT_TRUE(row_of("sleep 77 & cp right.exr {out}").ok()) << "who is left behind is not waited for";
  EXPECT_TRUE(row_of("exec >&- 2>&-; cp right.exr {out}").ok());
  EXPECT_TRUE(row_of("cat; cp right.exr {out}").ok()) << "there is no input to wait for";
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 70.0)
      << "nobody sleeps for 77 s";
}

TEST_F(Externals, ResumeKeepsARowUnlessItsCommandOrProgramChanged) {
  folder_.write("mine.sh", "cp right.exr $1\n");
  const double first = row_of("sh mine.sh {out}").timing.command_ms;
  EXPECT_EQ(row_of("sh mine.sh {out}", "", true).timing.command_ms, first);
  const double other = row_of("sh  mine.sh {out}", "", true).timing.command_ms;
  EXPECT_NE(other, first) << "another command";
  folder_.write("mine.sh", "cp  right.exr $1\n");
  EXPECT_NE(row_of("sh  mine.sh {out}", "", true).timing.command_ms, other) << "another program";
}

TEST_F(Externals, ScoredImagesStayWhenARunIsResumed) {
  run(suite_text({{"good", "scalar"}}));
  Results results = read_results(out());
  Row scored = results.rows[0];
  scored.id.technique = "theirs", scored.id.backend = external_backend, scored.timing = {};
  Row dropped = scored;
  dropped.id.technique = "dropped", dropped.timing.command_ms = 1.0;
  results.rows.push_back(scored), results.rows.push_back(dropped);
  write_results(out(), results);
  EXPECT_EQ(run(suite_text({{"good", "scalar"}}), true), 0);
  ASSERT_EQ(read_results(out()).rows.size(), 2u) << "what [[external]] no longer lists goes";
  EXPECT_EQ(row("theirs", "external").id.name(), scored.id.name());
}

TEST_F(Externals, MistakesInASuiteNameFileLineAndKey) {
  const auto error = [&](const std::string& text) {
    return error_of(
        [&] { load_suite(folder_.write("s.toml", "name = \"s\"\nscenes = [\"a\"]\n" + text), registry_, 1); });
  };
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{
           {"", "no [[technique]] is listed, and no [[external]]"},
           {"[[external]]\nname = \"a\"\n", "'external[0].command' is missing"},
           {external("a", "./mine {scene}"), "s.toml:5: key 'external[0].command' must say where {out}"},
           {external("a/b", "./mine {out}"), "s.toml:4: key 'external[0].name' is 'a/b', which holds '/'"},
           {external("a", "./mine {out}", "timeout_s = 0\n"), "'external[0].timeout_s'"},
           {external("a", "./mine {out}", "time = 1\n"), "command, name, reads_spheres, timeout_s"},
           {external("a", "1 {out}") + external("a", "2 {out}"), "lists a/external a second time"}})
    EXPECT_NE(error(text).find(why), std::string::npos) << error(text);
  EXPECT_EQ(error(external("a", "./mine {out}")), "");
}

TEST_F(Externals, OneChoiceOfSpheresIsEnoughForWhatDoesNotReadThem) {
  const std::string scene = folder_.write("spheres.toml", scene_named("spheres", constant, "spheres = 4\n"));
  const std::string head = "name = \"t\"\nscenes = [\"" + scene + "\"]\nspheres = [2, 4]\ntruth_noise = 0.05\n";
  run(head + external("mine", "test -s {scene}/spheres.json && cp right.exr {out}"));
  EXPECT_EQ(read_results(out()).rows.size(), 2u);
  run(head + external("mine", "cp right.exr {out}", "reads_spheres = false\n"));
  EXPECT_EQ(read_results(out()).rows.size(), 1u);
}

TEST(ExternalCommand, PathsAreQuotedForTheShell) {
  const auto external = make_external("a", "./mine {scene} -o {out} ${HOME} {other} {scene}");
  EXPECT_EQ(command_for(*external, "/tmp/a b", "/tmp/it's.exr"),
            "./mine '/tmp/a b' -o '/tmp/it'\\''s.exr' ${HOME} {other} '/tmp/a b'");
}

TEST(ForeignImage, ForgivesAndRefuses) {
  const TemporaryFolder folder;
  Receivers r = receivers_at(std::vector<vec3>(6, vec3(0.0f)));
  r.width = 3, r.height = 2;
  r.normal[4] = vec3(0.0f);
  const auto save = [&](const std::string& name, const std::vector<std::string>& channels, std::vector<float> values) {
    save_channels(folder.path() + "/" + name, {3, 2, channels, std::move(values), {}});
    return folder.path() + "/" + name;
  };
  const auto load = [&](const std::string& file) { return load_foreign_image(file, r, "s").pixels; };
  const auto error = [&](const std::string& file) { return error_of([&] { load(file); }); };
  const std::vector<vec3> expected = {vec3(0), vec3(1), vec3(2), vec3(3), vec3(0), vec3(-5)};
  EXPECT_EQ(load(save("grey.exr", {"Y"}, {0, 1, 2, 3, NAN, -5})), expected) << "invalid pixels may hold anything";
  std::vector<float> rgba;
  for (const float v : {0.0f, 1.0f, 2.0f, 3.0f, 4.0f, -5.0f}) rgba.insert(rgba.end(), {v, v, v, 0.5f});
  EXPECT_EQ(load(save("rgba.exr", {"R", "G", "B", "A"}, rgba)), expected);
  rgba[6] = INFINITY, rgba[13] = NAN;
  const std::string bad = error(save("bad.exr", {"R", "G", "B", "A"}, rgba));
  EXPECT_NE(bad.find("bad.exr: 2 of 6 pixels are not finite, the first in column 1, row 0: (1, 1, inf)"),
            std::string::npos)
      << bad;
  EXPECT_NE(error(save("depth.exr", {"Z"}, {0, 1, 2, 3, 4, 5})).find("depth.exr"), std::string::npos);
  save_png(folder.path() + "/a.png", {3, 2, expected});
  EXPECT_NE(error(folder.path() + "/a.png").find("whole numbers"), std::string::npos);
  EXPECT_NE(error(folder.path() + "/none.exr").find("no such image file"), std::string::npos);
  r.width = 6, r.height = 1;
  EXPECT_NE(error(folder.path() + "/grey.exr").find("3 x 2 pixels, and scene 's' has 6 x 1 receivers, its vertices"),
            std::string::npos);
}

TEST(ChildProcess, TellsHowACommandEnded) {
  std::string said;
  const auto line = [&](std::string_view text) { said += std::string(text) + "|"; };
  EXPECT_EQ(run_command("pwd; printf end", "/", 10.0, line).fault(), "");
  EXPECT_EQ(said, "/|end|");
  EXPECT_EQ(run_command("exit 2", "/", 10.0, line).fault(), "ended with exit code 2");
  EXPECT_EQ(run_command("true", "/no/such/folder", 10.0, line).fault(), "ended with exit code 126");
  EXPECT_GT(run_command("sleep 0.2", "/", 10.0, line).ms, 199.0);
  EXPECT_LT(run_command("sleep 0.2", "/", 10.0, line).ms, 2000.0);
  const CommandEnd slow = run_command("trap '' TERM INT; while :; do sleep 1; done", "/", 0.2, line);
  EXPECT_TRUE(slow.timed_out);
  EXPECT_NE(slow.fault().find("did not end within 0.2"), std::string::npos) << slow.fault();
}

}  // namespace
}  // namespace penumbra
