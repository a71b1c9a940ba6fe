// The program as a user meets it: output, one clear line on errors, exit codes.
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "harness/results/results_file.h"
#include "scenes/image.h"
#include "tests/cli/command_line.h"

namespace penumbra {
namespace {

using test::CommandLine;
using test::Outcome;

TEST_F(CommandLine, ListsInBothForms) {
  EXPECT_TRUE(std::regex_search(run("list").out, std::regex("\n  pixel-basis +environments +scalar, simd")));
  EXPECT_NE(run("list pixel-basis").out.find("visibility = table"), std::string::npos);
  const auto json = nlohmann::json::parse(run("list --json").out);
  EXPECT_GE(json["techniques"].size(), 4u);
  EXPECT_TRUE(json["techniques"][0].contains("parameters"));
}

TEST_F(CommandLine, RendersReferencesAndFits) {
  const std::string scene = tiny_scene();
  EXPECT_EQ(
      run("render " + scene + " --technique pixel-basis -p visibility=raster -o " + folder_.path() + "/a.exr").code, 0);
  EXPECT_EQ(load_image(folder_.path() + "/a.exr").width, 16);
  EXPECT_EQ(run("reference " + scene + " --rung cube -o " + folder_.path() + "/c.png").code, 0);
  EXPECT_NE(run("reference " + scene + " --rung cube").out.find("from the cache"), std::string::npos);
  EXPECT_EQ(run("fit torus-knot --spheres 8 -o " + folder_.path() + "/s.json").code, 0);
  EXPECT_EQ(nlohmann::json::parse(test::read_text(folder_.path() + "/s.json"))["spheres"].size(), 8u);
  EXPECT_EQ(load_image(folder_.path() + "/s.png").width, 3 * 480);
  const std::string report = run("fit box --spheres 2 --objective cover --seed 3 -o " + folder_.path() + "/b.json").out;
  for (const char* part : {"2 spheres for cover", "seed 3", "outside, summed", "coverage 100.000 %"})
    EXPECT_NE(report.find(part), std::string::npos) << report;
}

TEST_F(CommandLine, MistakesAreOneLineAndCodeTwo) {
  const std::string scene = tiny_scene();
  expect_error("render no-such-scene --technique pixel-basis -o x.exr", "bunny-city");
  expect_error("render " + scene + " --technique magic -o x.exr", "pixel-basis");
  expect_error("render " + scene + " --technique pixel-basis --backend gpu -o x.exr", "scalar");
  expect_error("render " + scene + " --technique pixel-basis -p visibility=maybe -o x.exr",
               "table, fine, raster, rays");
  expect_error("render " + scene + " --technique pixel-basis -p resolution=64 -o x.exr", "resolution 16 and 32");
  expect_error("render " + scene + " --technique pixel-basis -p colour=red -o x.exr", "no parameter 'colour'");
  expect_error("render " + scene + " --technique ray-traced -o x.jpeg2", ".exr or .png");
  const std::string lamp = folder_.write(
      "lamp.toml",
      "name = \"lamp\"\n[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 4 }\n"
      "[light]\narea = { centre = [0, 9, 0], normal = [0, -1, 0], radius = 1.0 }\n");
  expect_error("render " + lamp + " --technique pixel-basis -o x.exr", "cannot shade an area light");
  expect_error("reference " + scene + " --rung 13x13", "area lights");
  expect_error("reference " + scene + " --rung best", "truth");
  expect_error("fit teapot --spheres 4 -o s.json", "no such mesh file");
  expect_error("fit bowl --spheres 4 -o s.json", "96 of");
  expect_error("fit box --spheres 4 --objective best -o s.json", "cover, shadow, k-means, grid");
  expect_error("fit box --spheres 4 -o s.txt", ".json");
  expect_error("run no-such-suite", "quick");
  const Outcome usage = run("dance");
  EXPECT_EQ(usage.code, 2);
}

TEST_F(CommandLine, InitWritesWhatRunsAndOverwritesNothing) {
  const std::string study = folder_.path() + "/study";
  const Outcome first = run("init " + study);
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find("  penumbra run " + study + "/suite.toml --out"), std::string::npos) << first.out;
  const Outcome dry = run("run " + study + "/suite.toml --dry-run");
  EXPECT_EQ(dry.code, 0) << dry.err;
  EXPECT_NE(dry.out.find("scene: 16384 receivers, 64 spheres"), std::string::npos) << dry.out;

  const std::string scene = test::read_text(study + "/scene.toml");
  expect_error("init " + study, "scene.toml is there already");
  std::filesystem::remove(study + "/scene.toml");
  expect_error("init " + study, "suite.toml is there already");
  EXPECT_FALSE(std::filesystem::exists(study + "/scene.toml")) << "both or none";

  // The same, small enough for a test.
  const auto smaller = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  folder_.write("study/scene.toml",
                smaller(smaller(scene, "\nspheres = 64 ", "\nspheres = 2 "), "resolution = 128", "resolution = 16"));
  const Outcome done = run("run " + study + "/suite.toml --repetitions 1 --out " + study + "/results");
  EXPECT_EQ(done.code, 0) << done.err;
  const std::vector<Row> rows = read_results_path(study + "/results").rows;
  EXPECT_EQ(rows.size(), 5u);
  for (const Row& row : rows) EXPECT_EQ(row.status, "ok");
}

TEST_F(CommandLine, InitTakesAMeshOfOnesOwn) {
  const std::string open = folder_.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome o = run("init " + folder_.path() + "/own --mesh " + open);
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.err.find("without spheres"), std::string::npos) << o.err;
  const std::string listed = run("list " + folder_.path() + "/own/scene.toml").out;
  EXPECT_NE(listed.find(open + ": 1 triangles"), std::string::npos) << listed;
  EXPECT_NE(listed.find("none: techniques that need them are skipped"), std::string::npos) << listed;
  expect_error("init " + folder_.path() + "/other --mesh " + folder_.path() + "/none.obj", "none.obj");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/other"));
}

TEST_F(CommandLine, ReferencePrintsTheMeanOfEveryChannel) {
  const std::string scene = folder_.write(
      "open.toml",
      "name = \"open\"\n[occluder]\nmesh = \"none\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 16 }\n"
      "albedo = [0.797, 0.5, 0.0]\n[light]\nenvironment = \"constant\"\n");
  const Outcome line = run("reference " + scene + " --rung cube");
  EXPECT_NE(line.out.find("mean (0.79"), std::string::npos) << line.out;
  EXPECT_EQ(line.out.find('\n'), line.out.size() - 1) << line.out;
  const auto json = nlohmann::json::parse(run("reference " + scene + " --rung cube --json").out);
  EXPECT_NEAR(json["mean"][0].get<double>(), 0.797, 1e-3);
  EXPECT_NEAR(json["mean"][1].get<double>(), 0.5, 1e-3);
  EXPECT_EQ(json["mean"][2], 0.0);
  EXPECT_EQ(json["rel_noise"], 0.0);
  EXPECT_EQ(json["black"], false);
  const std::string mean =
      fmt::format("mean ({:.5g}, {:.5g}, 0)", json["mean"][0].get<double>(), json["mean"][1].get<double>());
  EXPECT_NE(line.out.find(mean), std::string::npos) << line.out << mean;
}

TEST_F(CommandLine, ABlackTruthAsksWhetherTheLampFacesAway) {
  const auto lamp = [&](const std::string& normal) {
    return folder_.write("lamp.toml",
                         "name = \"lamp\"\n[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, "
                         "resolution = 8, y = -1.0 }\n[light]\narea = { centre = [0, 9, 0], normal = " +
                             normal + ", radius = 1.0 }\n");
  };
  const std::string asked =
      "scene lamp: the truth is black: no receiver gets light; does the lamp face away? it shines "
      "along (0, 1, 0) from (0, 9, 0)\n";
  const std::string away = lamp("[0, 1e-25, 0]");
  const Outcome reference = run("reference " + away);
  EXPECT_EQ(reference.code, 0);
  EXPECT_EQ(reference.err, asked);
  EXPECT_NE(reference.out.find("standard error undefined"), std::string::npos) << reference.out;
  const auto json = nlohmann::json::parse(run("reference --json " + away).out);
  EXPECT_TRUE(json["rel_noise"].is_null());
  EXPECT_EQ(json["black"], true);
  EXPECT_EQ(run("render " + away + " --technique ray-traced -o " + folder_.path() + "/a.png").err, asked);
  const std::string suite =
      folder_.write("suite.toml", "name = \"s\"\nscenes = [\"" + away +
                                      "\"]\nrepetitions = 1\n[[technique]]\nname = \"ray-traced\"\n");
  EXPECT_NE(run("run " + suite + " --out " + folder_.path() + "/out").err.find(asked), std::string::npos);
  const auto down = nlohmann::json::parse(run("reference --json " + lamp("[0, -1, 0]")).out)["mean"];
  EXPECT_GT(down[0], 0.005);
  for (const char* normal : {"[0, -1e-25, 0]", "[0, -1e25, 0]", "[0, -1e-200, 0]", "[0, -1e300, 0]"}) {
    const Outcome facing = run("reference --json " + lamp(normal));
    EXPECT_EQ(facing.err, "") << normal;
    EXPECT_EQ(nlohmann::json::parse(facing.out)["mean"], down) << normal;
  }
  expect_error("reference " + lamp("[0, 0, 0]"), "must not be zero");
  for (const char* normal : {"[0, nan, 0]", "[0, inf, 0]", "[0, 1]", "\"down\""})
    expect_error("reference " + lamp(normal), "lamp.toml:7: key 'light.area.normal' must be three finite numbers");
}

TEST_F(CommandLine, ATruthThatIsNotFiniteIsAnError) {
  const std::string scene = folder_.write(
      "bright.toml",
      "name = \"bright\"\n[occluder]\nmesh = \"none\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 4 }\n"
      "[light]\narea = { centre = [0, 9, 0], normal = [0, -1, 0], radius = 1.0, radiance = [1e29, 1, 1] }\n");
  expect_error("reference " + scene, "truth: receiver 0 at");
  expect_error("reference " + scene, "variance inf");
}

TEST_F(CommandLine, NamesThatLeaveTheFolderAreRefused) {
  const std::string scene = folder_.write(
      "n.toml",
      "name = \"../../escape\"\n[occluder]\nmesh = \"none\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 4 "
      "}\n[light]\nenvironment = \"constant\"\n");
  const std::string suite =
      folder_.write("s.toml", "name = \"s\"\nscenes = [\"" + scene + "\"]\n[[technique]]\nname = \"ray-traced\"\n");
  const std::string why = "n.toml:1: key 'name' is '../../escape', which holds '/'; allowed";
  expect_error("reference " + scene, why);
  expect_error("render " + scene + " --technique ray-traced -o x.exr", why);
  expect_error("run " + suite + " --out " + folder_.path() + "/out", why);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/out"));
  const std::string named = folder_.write(
      "t.toml", "name = \"a/b\"\nscenes = [\"" + tiny_scene() + "\"]\n[[technique]]\nname = \"ray-traced\"\n");
  expect_error("run " + named + " --out " + folder_.path() + "/out", "t.toml:1: key 'name' is 'a/b'");
}

TEST_F(CommandLine, InterruptedRunsKeepFinishedRowsAndResume) {
  folder_.write("other.toml",
                "name = \"other\"\n[occluder]\nmesh = \"box\"\nspheres = 4\n[receivers]\n"
                "plane = { half_extent = 1.0, resolution = 96, y = -1.0 }\n[light]\nenvironment = \"constant\"\n");
  const std::string suite = folder_.write(
      "suite.toml",
      "name = \"s\"\nscenes = [\"" + tiny_scene() + "\", \"" + folder_.path() +
          "/other.toml\"]\ntruth_noise = 0.05\nrepetitions = 200\n"
          "[[technique]]\nname = \"pixel-basis\"\nbackend = \"simd\"\nparameters = { visibility = \"raster\" }\n");
  const std::string out = folder_.path() + "/out";
  const pid_t child = fork();
  if (child == 0) {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(99);
    execl(PENUMBRA_PROGRAM, PENUMBRA_PROGRAM, "run", suite.c_str(), "--out", out.c_str(), nullptr);
    _exit(99);
  }
  // The first scene's results appear, then the second one is under way: interrupt there.
  for (int tries = 0; tries < 1200 && !std::filesystem::exists(out + "/results.json"); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::vector<Row> rows = read_results_path(out).rows;
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].id.scene, "tiny");

  EXPECT_EQ(run("run " + suite + " --out " + out + " --repetitions 2 --resume").code, 0);
  const std::vector<Row> all = read_results_path(out).rows;
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].timing.frame_ms.size(), 200u) << "the finished row is kept as it was";
  EXPECT_EQ(all[1].timing.frame_ms.size(), 2u);
}

}  // namespace
}  // namespace penumbra
