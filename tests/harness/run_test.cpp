// A whole run with techniques that misbehave.
#include "harness/run.h"

#include "cuda/host/registry.h"
#include "cuda/host/runtime_host.h"
#include "harness/results.h"
#include "scenes/error.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// Radiance 1 everywhere, or whatever the mode says.
class Fake : public Technique {
 public:
  explicit Fake(std::string mode) : mode_(std::move(mode)) {}
  void prepare(const Scene&) override {
    if (mode_ == "throws") throw std::runtime_error("out of ideas");
    if (mode_ == "unsupported") throw Unsupported("not this scene");
  }
  void update(const Frame&) override { ++frames_; }
  void shade(View<vec3> radiance) override {
    if (mode_ == "throws-later" && frames_ > 3) throw std::runtime_error("tired");
    for (std::size_t i = 0; i < radiance.size(); ++i)
      radiance[i] = vec3(mode_ == "wrong" ? 0.9f : mode_ == "nan" ? NAN : 1.0f);
  }
  Footprint footprint() const override { return {1, 2, 3}; }

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

class Runs : public testing::Test {
 protected:
  Runs() {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    scene_ = folder_.write("scene.toml",
                           "name = \"tiny\"\n[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, "
                           "resolution = 16, y = -1.0 }\n"
                           "[light]\nenvironment = \"constant\"\n");
    for (const char* mode : {"good", "throws", "throws-later", "nan", "unsupported"})
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
    for (const Row& r : read_results(out()))
      if (r.technique == technique && r.backend == backend) return r;
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
  EXPECT_EQ(r.frame_ms.size(), 2u) << "one sample per repetition";
  EXPECT_GT(r.iterations, 0);
  EXPECT_EQ(r.bytes.total(), 6u);
  EXPECT_EQ(r.receivers, 256u);
  EXPECT_TRUE(r.errors.contains("truth") && r.errors.contains("cube"));
  EXPECT_FALSE(r.errors.contains("spheres")) << "the scene has none";
  EXPECT_GT(r.errors.at("truth").report.all.mean_signed, 0.0) << "no shadow at all leaks light";
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
  EXPECT_TRUE(row("good", "simd").frame_ms.empty()) << "what is wrong is not timed";
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
  EXPECT_LT(device.parity, 1e-3);
  ASSERT_EQ(device.stages.size(), 3u);
  EXPECT_EQ(device.stages[1].name, "kernels");
}

TEST_F(Runs, ABaselineIsOneMoreReference) {
  const std::string head = "baseline = { name = \"good\", backend = \"scalar\" }\n";
  EXPECT_EQ(run(head + suite_text({{"good", "scalar"}})), 0);
  EXPECT_EQ(row("good").errors.at("good").report.all.rmse, 0.0);
  EXPECT_NE(table_.find("against the image of good"), std::string::npos);
  EXPECT_EQ(run("baseline = { name = \"throws\", backend = \"scalar\" }\n" + suite_text({{"good", "scalar"}})), 0)
      << "a baseline that fails is left out";
  EXPECT_FALSE(row("good").errors.contains("throws"));
}

TEST_F(Runs, SkippedRowsAreNotFailures) {
  EXPECT_EQ(run(suite_text({{"unsupported", "scalar"}, {"absent", "simd"}})), 0);
}

TEST_F(Runs, ResumeKeepsGoodRowsAndMeasuresTheRest) {
  run(suite_text({{"good", "scalar"}, {"throws", "scalar"}}));
  const auto before = row("good").frame_ms;
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"unsupported", "scalar"}}), true), 0);
  EXPECT_EQ(row("good").frame_ms, before);
  EXPECT_EQ(read_results(out()).size(), 2u);
}

TEST_F(Runs, ResumeMeasuresAnewWhenTheSceneChanged) {
  run(suite_text({{"good", "scalar"}}));
  const std::string key = row("good").scene_key;
  folder_.write("scene.toml",
                "name = \"tiny\"\n[occluder]\nmesh = \"sphere\"\n[receivers]\nplane = { half_extent = 1.0, resolution "
                "= 16, y = -1.0 }\n"
                "[light]\nenvironment = \"constant\"\n");
  run(suite_text({{"good", "scalar"}}), true);
  EXPECT_NE(row("good").scene_key, key);
}

TEST_F(Runs, FilterChoosesRows) {
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"throws", "scalar"}}), false, "/good/"), 0);
  EXPECT_EQ(read_results(out()).size(), 1u);
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
