// A whole run with techniques that misbehave.
#include "harness/commands/run.h"

#include <csignal>
#include <set>

#include "cuda/host/registry.h"
#include "cuda/host/runtime_host.h"
#include "harness/measure/parity.h"
#include "harness/results/results_folder.h"
#include "scenes/error.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// Radiance 1 everywhere, or whatever the mode says.
class Fake : public Technique {
 public:
  explicit Fake(std::string mode) : mode_(std::move(mode)) {}
  void prepare(const Scene&) override {
    if (mode_ == "spy") seen = test::read_text(watched);
    if (mode_ == "signals" && --signals_at == 0) raise(SIGTERM);
    if (mode_ == "throws") throw std::runtime_error("out of ideas");
    if (mode_ == "unsupported") throw Unsupported("not this scene");
  }
  void update(const Frame&) override { ++frames_; }
  void shade(View<vec3> radiance) override {
    if (mode_ == "throws-later" && frames_ > 3) throw std::runtime_error("tired");
    for (std::size_t i = 0; i < radiance.size(); ++i)
      radiance[i] = vec3(mode_ == "wrong" ? 0.9f : mode_ == "nan" ? NAN : mode_ == "black" ? 0.0f : 1.0f);
  }
  Footprint footprint() const override { return {1, 2, 3}; }

  static inline int signals_at = 0;         ///< "signals": at which preparation from now on
  static inline std::string watched, seen;  ///< "spy": what the file held when the last scene was prepared

 private:
  std::string mode_;
  int frames_ = 0;
};

Entry fake(const std::string& name, const std::string& backend, const std::string& mode) {
  Entry e;
  e.name = name, e.backend = backend;
  e.lights = {true, mode != "no-area"};
  e.make = [mode](const Parameters&) { return std::make_unique<Fake>(mode); };
  return e;
}

std::string scene_named(const std::string& name, const std::string& light, const std::string& spheres = "") {
  return "name = \"" + name + "\"\n[occluder]\nmesh = \"box\"\n" + spheres +
         "[receivers]\nplane = { half_extent = 1.0, resolution = 16, y = -1.0 }\n[light]\n" + light + "\n";
}

constexpr const char* constant = "environment = \"constant\"";

/// A suite of several scenes and one technique.
std::string suite_of(const std::vector<std::string>& scenes, const std::string& technique = "good",
                     const std::string& more = "") {
  std::string list;
  for (const std::string& scene : scenes) list += (list.empty() ? "\"" : ", \"") + scene + "\"";
  return "name = \"t\"\nscenes = [" + list + "]\ntruth_noise = 0.05\n" + more + "[[technique]]\nname = \"" + technique +
         "\"\nbackend = \"scalar\"\n";
}

class Runs : public testing::Test {
 protected:
  Runs() {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    scene_ = folder_.write("scene.toml",
                           "name = \"tiny\"\n[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, "
                           "resolution = 16, y = -1.0 }\n"
                           "[light]\nenvironment = \"constant\"\n");
    for (const char* mode : {"good", "throws", "throws-later", "nan", "unsupported", "black", "spy"})
      registry_.add(fake(mode, "scalar", mode));
    registry_.add(fake("good", "simd", "wrong"));
    Entry absent = fake("absent", "simd", "good");
    absent.unavailable = "no device";
    registry_.add(absent);
  }
  ~Runs() override { unsetenv("PENUMBRA_CACHE"); }

  std::string suite_text(const std::vector<std::pair<std::string, std::string>>& techniques) const {
    std::string text = "name = \"t\"\nscenes = [\"" + scene_ + "\"]\ntruth_noise = 0.05\n";
    for (const auto& [name, backend] : techniques)
      text += "[[technique]]\nname = \"" + name + "\"\nbackend = \"" + backend + "\"\n";
    return text;
  }
  int run(const std::string& text, bool resume = false, const std::string& filter = ".*") {
    const Suite suite = load_suite(folder_.write("suite.toml", text), registry_, 1);
    testing::internal::CaptureStdout();
    const int code = run_suite(suite, registry_, {out(), filter, 2, resume});
    table_ = testing::internal::GetCapturedStdout();
    return code;
  }
  std::string out() const { return folder_.path() + "/out"; }
  Row row(const std::string& technique, const std::string& backend = "scalar") const {
    for (const Row& r : read_results(out()).rows)
      if (r.id.technique == technique && r.id.backend == backend) return r;
    ADD_FAILURE() << "no row for " << technique;
    return {};
  }

  test::TemporaryFolder folder_;
  std::string scene_, table_;
  Registry registry_;
};

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
  for (const char* file : {"table.md", "images/tiny-0-spheres/truth.exr", "images/tiny-0-spheres/truth.png",
                           "images/tiny-0-spheres/good-scalar-threads-1.error.png"})
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
  EXPECT_TRUE(device.ok());
  EXPECT_LT(device.score.parity, 1e-3);
  ASSERT_EQ(device.timing.stages.size(), 3u);
  EXPECT_EQ(device.timing.stages[1].name, "kernels");
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

TEST_F(Runs, ResumeKeepsGoodRowsAndMeasuresTheRest) {
  run(suite_text({{"good", "scalar"}, {"throws", "scalar"}}));
  const auto before = row("good").timing.frame_ms;
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"unsupported", "scalar"}}), true), 0);
  EXPECT_EQ(row("good").timing.frame_ms, before);
  EXPECT_EQ(read_results(out()).rows.size(), 2u);
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

/// Edits the context of what is on disk.
void edit_context(const std::string& folder, const std::string& field, const nlohmann::json& value) {
  Results results = read_results(folder);
  results.context[field] = value;
  write_results(folder, results);
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
  registry_.add(fake("signals", "scalar", "signals"));
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
  Entry blind = fake("blind", "scalar", "good");
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
  std::filesystem::create_directories(out() + "/results.json.partial/full");
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
  for (const auto& saved : file["benchmarks"]) on_disk.insert(saved["scene"]);
  EXPECT_TRUE(on_disk.contains("a")) << "finished";
  EXPECT_TRUE(on_disk.contains("c")) << "not reached";
  EXPECT_EQ(read_results(out()).rows.size(), 3u);
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
