// A whole run with techniques that misbehave.
#include "cuda/host/registry.h"
#include "cuda/host/runtime_host.h"
#include "harness/catalogue/catalogue.h"
#include "harness/measure/parity.h"
#include "tests/harness/runs.h"

namespace penumbra {
namespace {

using namespace test;

TEST_F(Runs, GoodRowsAreMeasuredAndWritten) {
  EXPECT_EQ(run(suite_text({{"good", "scalar"}})), 0);
  const Row r = row("good");
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.timing.frame_ms.size(), 2u) << "one sample per repetition";
  EXPECT_GT(r.timing.iterations, 0);
  EXPECT_EQ(r.facts.bytes.total(), 6u);
  EXPECT_EQ(r.id.receivers, 256u);
  EXPECT_TRUE(r.score.errors.contains("truth") && r.score.errors.contains("cube"));
  EXPECT_FALSE(r.score.errors.contains("spheres")) << "the scene has none";
  EXPECT_GT(r.score.errors.at("truth").report.all.mean_signed, 0.0) << "no shadow at all leaks light";
  EXPECT_EQ(r.facts.image, "images/tiny-0-spheres/good-scalar-threads-1");
  const std::string tables = test::read_text(out() + "/table.md");
  EXPECT_TRUE(tables.starts_with("# t\n\n- machine: ")) << tables;
  EXPECT_NE(tables.find("- measured: 2 repetitions"), std::string::npos) << tables;
  for (const char* file : {"table.md", "images/tiny-0-spheres/overview.png", "images/tiny-0-spheres/truth.exr",
                           "images/tiny-0-spheres/truth.png", "images/tiny-0-spheres/good-scalar-threads-1.error.png"})
    EXPECT_TRUE(std::filesystem::exists(out() + "/" + file)) << file;
}

TEST_F(Runs, FailuresAreRowsAndTheRunGoesOn) {
  EXPECT_EQ(run(suite_text({{"throws", "scalar"},
                            {"nan", "scalar"},
                            {"good", "simd"},
                            {"throws-later", "scalar"},
                            {"unsupported", "scalar"},
                            {"absent", "simd"},
                            {"good", "scalar"}})),
            1);
  EXPECT_EQ(row("throws").status, "failed: out of ideas");
  EXPECT_EQ(row("throws-later").status, "failed: tired");
  EXPECT_NE(row("nan").status.find("failed: receiver 0"), std::string::npos);
  EXPECT_NE(row("good", "simd").status.find("differs from its scalar twin"), std::string::npos);
  EXPECT_TRUE(row("good", "simd").timing.frame_ms.empty()) << "what is wrong is not timed";
  EXPECT_EQ(row("unsupported").status, "skipped: not this scene");
  EXPECT_EQ(row("absent", "simd").status, "skipped: no device");
  EXPECT_TRUE(row("good").ok());
  EXPECT_NE(table_.find("out of ideas"), std::string::npos);
}

TEST_F(Runs, WithoutDeviceMemoryTheRowFailsAndTheCpuGoesOn) {
  const Registry all = cuda_on_host::make_registry();
  if (make_registry().find("sh-lighting", "cuda").unavailable.empty()) GTEST_SKIP() << "a device has its own limit";
  for (const char* backend : {"scalar", "cuda"}) registry_.add(all.find("sh-lighting", backend));
  const std::string suite = suite_text({{"sh-lighting", "cuda"}, {"sh-lighting", "scalar"}});
  cuda_on_host::set_memory_limit(1000);
  EXPECT_EQ(run(suite), 1);
  cuda_on_host::set_memory_limit(~std::size_t(0));
  EXPECT_TRUE(row("sh-lighting").ok());
  EXPECT_NE(row("sh-lighting", "cuda").status.find("failed: out of device memory"), std::string::npos)
      << row("sh-lighting", "cuda").status;

  EXPECT_EQ(run(suite), 0);
  const Row device = row("sh-lighting", "cuda");
  EXPECT_NE(device.status.find("its times cannot be used: repetition 0 took 0 ms"), std::string::npos)
      << device.status << ": the host's execution of kernels has no time";
  EXPECT_LT(device.score.parity, 1e-3);
}

TEST_F(Runs, ABaselineIsOneMoreReference) {
  const std::string head = "baseline = { name = \"good\", backend = \"scalar\" }\n";
  EXPECT_EQ(run(head + suite_text({{"good", "scalar"}})), 0);
  EXPECT_EQ(row("good").score.errors.at("good").report.all.rmse, 0.0);
  EXPECT_NE(table_.find("against the image of good"), std::string::npos);
  EXPECT_EQ(run("baseline = { name = \"throws\", backend = \"scalar\" }\n" + suite_text({{"good", "scalar"}})), 0)
      << "a baseline that fails is left out";
  EXPECT_FALSE(row("good").score.errors.contains("throws"));
}

TEST_F(Runs, SkippedRowsAreNotFailures) {
  EXPECT_EQ(run(suite_text({{"unsupported", "scalar"}, {"absent", "simd"}, {"good", "scalar"}})), 0);
}

TEST_F(Runs, ARunThatMeasuresNothingSaysSo) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(suite_text({{"unsupported", "scalar"}, {"absent", "simd"}})), 1);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("every row was skipped: no device; not this scene"), std::string::npos) << said;
}

TEST_F(Runs, WhatCannotRunHereIsRefusedWithItsReason) {
  EXPECT_NE(test::error_of([&] {
              run(suite_text({{"absent", "simd"}}));
            }).find("can run here: simd: no device"),
            std::string::npos);
  testing::internal::GetCapturedStdout();
  EXPECT_FALSE(std::filesystem::exists(out()));
  const Entry& absent = registry_.find("absent", "simd");
  EXPECT_THROW(make_technique(absent, {}), Unsupported);
}

TEST_F(Runs, OneSceneIsLoadedIfTheFilterLeavesOne) {
  const std::string other =
      folder_.write("other.toml",
                    "name = \"other\"\n[occluder]\nmesh = \"missing.obj\"\n[receivers]\nplane = { half_extent = 1.0, "
                    "resolution = 16 }\n[light]\nenvironment = \"constant\"\n");
  EXPECT_EQ(run(suite_of({scene_, other}), false, "^tiny/"), 0) << "the other one is not even looked at";
  EXPECT_NE(test::error_of([&] { run(suite_of({scene_, other})); }).find("missing.obj"), std::string::npos);
  testing::internal::GetCapturedStdout();
}

TEST_F(Runs, WhatDoesNotReadSpheresIsMeasuredOnce) {
  Entry blind = fake("blind", Backend::scalar, "good");
  blind.reads_spheres = [](const Parameters&) { return false; };
  registry_.add(blind);
  const std::string suite =
      suite_of({scene_}, "blind", "spheres = [2, 4]\n") + "[[technique]]\nname = \"good\"\nbackend = \"scalar\"\n";
  EXPECT_EQ(run(suite), 0);
  EXPECT_EQ(read_results(out()).rows.size(), 3u);
  EXPECT_FALSE(row("blind").id.reads_spheres);
  EXPECT_EQ(run(suite, false, "spheres:4/.*blind"), 0) << "the first choice that the filter leaves";
  EXPECT_EQ(row("blind").id.spheres, 4u);
}

TEST_F(Runs, FilterChoosesRows) {
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"throws", "scalar"}}), false, "/good/"), 0);
  EXPECT_EQ(read_results(out()).rows.size(), 1u);
  EXPECT_NE(test::error_of([&] {
              run(suite_text({{"good", "scalar"}}), false, "zzz");
            }).find("leaves nothing"),
            std::string::npos);
  testing::internal::GetCapturedStdout();
  EXPECT_NE(test::error_of([&] {
              run(suite_text({{"good", "scalar"}}), false, "(");
            }).find("regular expression"),
            std::string::npos);
  testing::internal::GetCapturedStdout();
}

TEST_F(Runs, WrongInputTouchesNothing) {
  run(suite_text({{"good", "scalar"}}));
  const std::string before = test::read_text(out() + "/results.json");
  std::ofstream(scene_) << "name = 3\n";
  EXPECT_NE(test::error_of([&] { run(suite_text({{"good", "scalar"}})); }), "");
  testing::internal::GetCapturedStdout();
  EXPECT_EQ(test::read_text(out() + "/results.json"), before);
}

TEST_F(Runs, OnABlackTruthNothingIsBest) {
  Image below{32, 16, std::vector<vec3>(32 * 16, vec3(0.0f))};
  for (int i = 32 * 8; i < 32 * 16; ++i) below.pixels[i] = vec3(1.0f);
  save_exr(folder_.path() + "/below.exr", below);
  for (const std::string light :
       {"environment = \"below.exr\"", "area = { centre = [0, 3, 0], normal = [0, 1, 0], radius = 0.5 }",
        "area = { centre = [0, 3, 0], edge_u = [0, 0, 1], edge_v = [1, 0, 0], radiance = [1e9, 1e9, 1e9] }"}) {
    const std::string scene = folder_.write("dark.toml", scene_named("dark", light));
    const std::string suite = suite_of({scene}) + "[[technique]]\nname = \"black\"\nbackend = \"scalar\"\n";
    testing::internal::CaptureStderr();
    EXPECT_EQ(run(suite), 0);
    const std::string notes = testing::internal::GetCapturedStderr();
    EXPECT_NE(notes.find("scene dark: the truth is black: no receiver gets light"), std::string::npos) << notes;
    for (const char* technique : {"good", "black"}) {
      const Errors truth = row(technique).score.errors.at("truth").report.all;
      EXPECT_FALSE(truth.rel_rmse || truth.psnr) << light;
      EXPECT_NEAR(truth.rmse, technique == std::string("good") ? 1.0 : 0.0, 1e-6);
    }
    EXPECT_NE(table_.find("undefined (RMSE 1)"), std::string::npos) << table_;
    for (const char* wrong : {"| P |", "(tie) |", " ms, ", "inf", "nan"})
      EXPECT_EQ(table_.find(wrong), std::string::npos) << wrong << " in " << table_;
    EXPECT_EQ(run(suite, true), 0) << "what is on disk reads back";
    EXPECT_EQ(read_results(out()).rows.size(), 2u);
  }
}

TEST_F(Runs, ScenesOfOneNameAreRefusedBeforeAnythingIsMeasured) {
  const auto file = [&](const char* stem, const std::string& name) {
    return folder_.write(std::string(stem) + ".toml", scene_named(name, constant));
  };
  const auto refused = [&](const std::string& suite) {
    const std::string error = test::error_of([&] { run(suite); });
    testing::internal::GetCapturedStdout();
    EXPECT_FALSE(std::filesystem::exists(out())) << error;
    return error;
  };
  const std::string a = file("a", "same"), b = file("b", "same"), upper = file("c", "Same"), blank = file("d", "x y"),
                    dash = file("e", "x-y");
  std::string error = refused(suite_of({a, b}));
  for (const char* part : {"suite.toml:2: key 'scenes'", "a.toml:1", "b.toml:1", "allowed"})
    EXPECT_NE(error.find(part), std::string::npos) << error;
  EXPECT_NE(refused(suite_of({a, upper})).find("'Same'"), std::string::npos);
  EXPECT_NE(refused(suite_of({blank, dash})).find("'x-y'"), std::string::npos);
  error = refused(suite_of({a, a}));
  EXPECT_NE(error.find("lists " + a + " twice"), std::string::npos) << error;
  EXPECT_NE(refused(suite_of({a, folder_.path() + "/./a.toml"})).find("twice"), std::string::npos);
  error = refused(suite_of({a}, "good", "spheres = [4, 4]\n"));
  EXPECT_NE(error.find("suite.toml:4: scene 'same' has 4 spheres"), std::string::npos) << error;
  EXPECT_EQ(run(suite_of({a, dash}, "good", "spheres = [2, 4]\nobjective = [\"cover\", \"shadow\"]\n")), 0)
      << "one scene with several sets of spheres";
  EXPECT_EQ(read_results(out()).rows.size(), 8u);
}

TEST_F(Runs, PathsOfScenesStartAtTheSuitesFolder) {
  EXPECT_EQ(run(suite_of({"scene.toml"})), 0);
  const auto error = [&](const std::string& scene) {
    const std::string text = test::error_of([&] { run(suite_of({scene})); });
    testing::internal::GetCapturedStdout();
    return text;
  };
  EXPECT_NE(
      error("sub/scene.toml").find("suite.toml:2: key 'scenes': " + folder_.path() + "/sub/scene.toml is no file"),
      std::string::npos)
      << error("sub/scene.toml");
  EXPECT_NE(error("bunny-town").find("suite.toml:2: key 'scenes': 'bunny-town' is neither"), std::string::npos);
  std::ofstream("elsewhere.toml") << scene_named("elsewhere", constant);  // where the program happens to run
  EXPECT_NE(error("elsewhere.toml"), "");
  std::filesystem::remove("elsewhere.toml");
}

TEST_F(Runs, VariantsListedTwiceAreRefused) {
  const std::string error = test::error_of([&] { run(suite_text({{"good", "scalar"}, {"good", "scalar"}})); });
  EXPECT_NE(error.find("good/scalar/threads:1 a second time"), std::string::npos) << error;
  EXPECT_NE(error.find("suite.toml:8"), std::string::npos) << error;
}

TEST_F(Runs, ImagesThatCannotBeWrittenCostNoRow) {
  std::filesystem::create_directories(out() + "/images");
  std::ofstream(out() + "/images/tiny-0-spheres") << "in the way of the folder";
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"spy", "scalar"}})), 0);
  EXPECT_TRUE(row("good").ok() && row("spy").ok());
  EXPECT_EQ(row("good").timing.frame_ms.size(), 2u);
}

TEST_F(Runs, ResultsThatCannotBeWrittenAreStillPrinted) {
  std::filesystem::create_directories(out() + "/results.json/full");
  EXPECT_EQ(run(suite_text({{"good", "scalar"}})), 1);
  EXPECT_NE(table_.find("| good | scalar |"), std::string::npos) << table_;
}

TEST_F(Runs, ASceneWithoutATruthFailsAndTheOthersAreMeasured) {
  const std::string bright = folder_.write(
      "bright.toml",
      scene_named("bright", "area = { centre = [0, 3, 0], normal = [0, -1, 0], radius = 1, radiance = [1e29, 1, 1] }"));
  EXPECT_EQ(run(suite_of({bright, scene_})), 1);
  const std::vector<Row> rows = read_results(out()).rows;
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(rows[0].status.starts_with("failed: truth: receiver 0")) << rows[0].status;
  EXPECT_TRUE(rows[1].ok());
}

TEST(Thinned, KeepsEveryStrideThReceiver) {
  Scene scene = test::sphere_scene({}, make_receivers({PlaneGrid{1.0f, 100, 0.0f}, vec3(1.0f)}, {}));
  const Scene thin = thinned(scene, 32);
  EXPECT_EQ(thin.receivers.width, 25);
  EXPECT_EQ(thin.receivers.position[1], scene.receivers.position[4]);
  EXPECT_EQ(thin.receivers.position[25], scene.receivers.position[400]);
  scene.receivers = test::receivers_at(std::vector<vec3>(3000, vec3(1.0f)));
  EXPECT_EQ(thinned(scene, 32).receivers.width, 1000);
}

}  // namespace
}  // namespace penumbra
