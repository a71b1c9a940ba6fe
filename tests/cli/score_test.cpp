// Images of other renderers as a user meets them: export, score, and the frame that all commands mean.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "harness/results/results_file.h"
#include "harness/results/row_json.h"
#include "scenes/image.h"
#include "tests/cli/command_line.h"

namespace penumbra {
namespace {

using nlohmann::json;
using test::Outcome;

class Score : public test::CommandLine {
 protected:
  std::string out() const { return folder_.path() + "/out"; }
  std::string image(const std::string& name) const { return folder_.path() + "/" + name; }
  json rows() const {
    json all = json::array();
    for (const Row& row : read_results_path(out()).rows) all.push_back(to_json(row));
    return all;
  }
  json row(const std::string& technique, const std::string& backend) const {
    for (const json& r : rows())
      if (r["technique"] == technique && r["backend"] == backend) return r;
    ADD_FAILURE() << "no row " << technique;
    return {};
  }
  std::string twisting_scene() const {
    return folder_.write(
        "twisting.toml",
        "name = \"twisting\"\n[occluder]\nmesh = \"box\"\nspheres = 4\n[receivers]\nplane = { half_extent = 1.5, "
        "resolution = 24, y = -1.0 }\n[light]\nenvironment = \"sun-sky\"\n[motion]\nkind = \"twist\"\nframes = 12\n");
  }
};

TEST_F(Score, OfARenderedImageGivesTheErrorsOfARunToTheBit) {
  const std::string scene = twisting_scene();
  const std::string suite = folder_.write(
      "suite.toml",
      "name = \"s\"\nscenes = [\"" + scene +
          "\"]\nrepetitions = 1\ntruth_noise = 0.02\nthreads = 2\n"
          "[[technique]]\nname = \"ray-traced\"\nbackend = \"simd\"\nparameters = { rays = 4 }\n"
          "[[technique]]\nname = \"pixel-basis\"\nbackend = \"simd\"\nparameters = { visibility = \"raster\" }\n"
          "[[technique]]\nname = \"sh-exponentiation\"\nbackend = \"simd\"\n"
          "[[technique]]\nname = \"pixel-basis\"\nbackend = \"scalar\"\nparameters = { resolution = 16, visibility = "
          "\"raster\" }\n");
  ASSERT_EQ(run("run " + suite + " --out " + out()).code, 0);
  const json before = rows();
  const std::vector<std::array<std::string, 3>> variants = {
      {"ray-traced", "simd", "-p rays=4"},
      {"pixel-basis", "simd", "-p visibility=raster"},
      {"sh-exponentiation", "simd", ""},
      {"pixel-basis", "scalar", "-p resolution=16 -p visibility=raster"}};
  for (const auto& [technique, backend, parameters] : variants) {
    const std::string file = image(technique + backend + ".exr");
    const Outcome rendered = run("render " + scene + " --technique " + technique + " --backend " + backend + " " +
                                 parameters + " -o " + file);
    EXPECT_NE(rendered.out.find("frame 4 of 0 to 11"), std::string::npos) << rendered.out;
    const Outcome scored = run("score " + scene + " " + file + " --noise 0.02 --json --out " + out() +
                               (backend == "scalar" ? " --resolution 16" : ""));
    ASSERT_EQ(scored.code, 0) << scored.err;
    const json theirs = json::parse(scored.out), ours = row(technique, backend);
    EXPECT_EQ(theirs["errors"], ours["errors"]) << technique << " " << backend;
    EXPECT_EQ(theirs["geometry_rel_rmse"], ours["geometry_rel_rmse"]);
    EXPECT_EQ(theirs["technique"], technique + backend);
    EXPECT_EQ(theirs["backend"], "external");
    EXPECT_EQ(theirs["frame"], 4);
    EXPECT_TRUE(theirs["frame_ms"].is_null());
    EXPECT_GT(ours["errors"]["truth"]["rel_rmse"], 0.0);
  }
  EXPECT_EQ(rows().size(), before.size() + variants.size());
  for (const json& r : before) EXPECT_EQ(row(r["technique"], r["backend"]), r) << "rows beside it stay as they were";
}

TEST_F(Score, TellsEveryMetricWhereItStandsAndWhereTheErrorMapIs) {
  const std::string scene = tiny_scene(), file = image("theirs.exr");
  save_exr(file, {16, 16, std::vector<vec3>(256, vec3(0.9f))});
  const Outcome first = run("score " + scene + " " + file + " --noise 0.05 --time 3 --time 5 --out " + out());
  ASSERT_EQ(first.code, 0) << first.err;
  for (const char* part : {"theirs.exr: scene 'tiny'", "256 receivers", "truth", "cube", "spheres", "umbra", "lit",
                           "theirs-external.error.png and .exr", "results.json"})
    EXPECT_NE(first.out.find(part), std::string::npos) << part << "\n" << first.out;
  EXPECT_EQ(row("theirs", "external")["frame_ms"], 4.0);
  EXPECT_EQ(row("theirs", "external")["samples"]["frame_ms"], (json{3.0, 5.0}));
  EXPECT_EQ(row("theirs", "external")["errors"]["truth"]["mean_signed"] > 0.0, true);
  const std::string folder = out() + "/images/tiny-4-spheres-shadow/theirs-external";
  const Image error = load_image(folder + ".error.exr"),
              truth = load_image(out() + "/images/tiny-4-spheres-shadow/truth.exr");
  for (const std::size_t i : {0u, 100u, 255u}) EXPECT_EQ(error.pixels[i].x, 0.9f - truth.pixels[i].x);
  EXPECT_TRUE(std::filesystem::exists(folder + ".error.png"));

  const Outcome second = run("score " + scene + " " + file + " --noise 0.05 --name 'other one' --out " + out());
  EXPECT_NE(second.out.find("Number 1 of 2 rows"), std::string::npos) << second.out;
  EXPECT_NE(second.out.find("no time  other one external"), std::string::npos) << second.out;
  EXPECT_EQ(rows().size(), 2u);
  run("score " + scene + " " + file + " --noise 0.05 --out " + out());
  EXPECT_EQ(rows().size(), 2u) << "a row of the same name takes the place of the old one";
  std::istringstream lines(second.out);
  for (std::string line; std::getline(lines, line);)
    if (line.find('/') == std::string::npos) EXPECT_LE(line.size(), 100u) << line;
}

TEST_F(Score, MistakesAreOneLineAndCodeTwo) {
  const std::string scene = tiny_scene(), right = image("right.exr"), wrong = image("wrong.exr");
  save_exr(right, {16, 16, std::vector<vec3>(256, vec3(1.0f))});
  save_exr(wrong, {8, 16, std::vector<vec3>(128, vec3(1.0f))});
  const std::string to = " --noise 0.05 --out " + out();
  expect_error("score " + scene + " " + wrong + to, "is 8 x 16 pixels, and scene 'tiny' has 16 x 16 receivers");
  expect_error("score " + scene + " " + image("none.exr") + to, "no such image file");
  expect_error("score " + scene + " " + right + to + " --time -1", "--time -1");
  expect_error("score " + scene + " " + right + to + " --name a/b", "--name is 'a/b', which holds '/'");
  expect_error("score " + scene + " " + right + to + " --frame 1", "--frame 1: scene 'tiny' does not move");
  expect_error("score " + twisting_scene() + " " + right + to + " --frame 12", "has the frames 0 to 11");
  expect_error("export " + scene + " -o " + right + "/x", "cannot be made");
  expect_error("export " + twisting_scene() + " -o " + image("e") + " --frame -1", "has the frames 0 to 11");
  EXPECT_FALSE(std::filesystem::exists(out() + "/results.json"));
  ASSERT_EQ(run("score " + scene + " " + right + to).code, 0);
  expect_error("score " + scene + " " + right + " --noise 0.04 --out " + out(), "measured against another truth");
  EXPECT_EQ(rows().size(), 1u);
}

TEST_F(Score, BlackTruthsAndVerticesAreScored) {
  const std::string away = folder_.write("away.toml",
                                         "name = \"away\"\n[occluder]\nmesh = \"box\"\n[receivers]\nvertices = "
                                         "true\n[light]\narea = { centre = [0, 9, 0], "
                                         "normal = [0, 1, 0], radius = 1.0 }\n");
  ASSERT_EQ(run("reference " + away + " -o " + image("black.exr")).code, 0);
  const Outcome scored = run("score " + away + " " + image("black.exr") + " --out " + out());
  EXPECT_EQ(scored.code, 0) << scored.err;
  EXPECT_NE(scored.err.find("the truth is black"), std::string::npos) << scored.err;
  EXPECT_NE(scored.out.find("undefined"), std::string::npos) << scored.out;
  EXPECT_TRUE(row("black", "external")["errors"]["truth"]["rel_rmse"].is_null());
}

TEST_F(Score, FramesAreTheSameForEveryCommand) {
  const std::string scene = twisting_scene();
  const auto mean = [&](const std::string& more) {
    return json::parse(run("reference " + scene + " --rung cube --json" + more).out);
  };
  EXPECT_EQ(mean("")["frame"], 4);
  EXPECT_EQ(mean("")["mean"], mean(" --frame 4")["mean"]);
  EXPECT_NE(mean("")["mean"], mean(" --frame 0")["mean"]);
  const Outcome line = run("reference " + scene + " --rung cube --frame 2");
  EXPECT_NE(line.out.find("twisting frame 2 of 0 to 11 cube"), std::string::npos) << line.out;
  EXPECT_EQ(run("export " + scene + " -o " + image("e")).code, 0);
  EXPECT_EQ(json::parse(test::read_text(image("e/scene.json")))["frame"], 4);
  const Outcome second = run("export " + scene + " -o " + image("e") + " --frame 2");
  EXPECT_NE(second.out.find("--frame 2"), std::string::npos) << second.out;
  ASSERT_EQ(run("reference " + scene + " --rung cube --frame 2 -o " + image("two.exr")).code, 0);
  const Outcome scored =
      run("score " + scene + " " + image("two.exr") + " --noise 0.05 --frame 2 --json --out " + out());
  ASSERT_EQ(scored.code, 0) << scored.err;
  EXPECT_EQ(json::parse(scored.out)["errors"]["cube"]["rmse"], 0.0);
  EXPECT_EQ(json::parse(scored.out)["parameters"]["frame"], 2);
}

TEST_F(Score, AnInterruptKillsAnExternalCommandAtOnce) {
  const std::string suite = folder_.write(
      "suite.toml",
      "name = \"s\"\nscenes = [\"" + tiny_scene() +
          "\"]\ntruth_noise = 0.05\n[[external]]\nname = \"mine\"\n"
          "command = \"trap '' INT TERM; sleep 60 & echo $! > pid; mv pid started; wait; sleep 60; : {out}\"\n");
  const pid_t child = fork();
  if (child == 0) {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(99);
    execl(PENUMBRA_PROGRAM, PENUMBRA_PROGRAM, "run", suite.c_str(), "--out", out().c_str(), nullptr);
    _exit(99);
  }
  for (int tries = 0; tries < 600 && !std::filesystem::exists(image("started")); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const std::string grandchild = test::read_text(image("started"));
  const auto lives = [&] {  // who has ended may wait for its init to take notice
    const std::string stat = test::read_text("/proc/" + std::to_string(std::stoi(grandchild)) + "/stat");
    return !stat.empty() && stat.find(") Z ") == std::string::npos;
  };
  EXPECT_TRUE(lives());
  const auto start = std::chrono::steady_clock::now();
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 2.0);
  EXPECT_FALSE(lives()) << "nothing that it started is left";
}

}  // namespace
}  // namespace penumbra
