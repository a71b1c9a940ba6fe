// What variants of a scene are scored against, and what is said of the scene.
#include "harness/measure/scene_context.h"

#include <fmt/format.h>

#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

class SceneContexts : public testing::Test {
 protected:
  SceneContexts() {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    suite_.truth_noise = 0.05;
  }
  ~SceneContexts() override { unsetenv("PENUMBRA_CACHE"); }

  Scene scene(const std::string& occluder, double half_extent = 1.5, const std::string& more = "") {
    return load_scene(folder_.write(
        "scene.toml", fmt::format("name = \"tiny\"\n[occluder]\n{}\n[receivers]\nplane = {{ half_extent = {}, "
                                  "resolution = 16, y = -1.0 }}\n[light]\nenvironment = \"sun-sky\"\n{}",
                                  occluder, half_extent, more)));
  }
  /// What is said once all references are there.
  std::string said(Scene scene, const std::vector<Rung>& rungs) {
    SceneContext context(std::move(scene), suite_);
    for (const Rung rung : rungs) context.add_reference(rung, rung == Rung::truth ? 0 : 16);
    testing::internal::CaptureStderr();
    Progress progress;
    context.finish_references(progress);
    return testing::internal::GetCapturedStderr();
  }

  test::TemporaryFolder folder_;
  Suite suite_;
};

TEST_F(SceneContexts, TheScoredFrameIsAThirdThroughTheMotion) {
  const SceneContext context(scene("mesh = \"box\"", 1.5, "[motion]\nkind = \"twist\"\nframes = 12\n"), suite_);
  EXPECT_EQ(context.frame().time, 4.0);
  EXPECT_EQ(context.folder(), "tiny-0-spheres");
}

TEST_F(SceneContexts, ScoresAgainstEveryRungOfItsResolution) {
  SceneContext context(scene("mesh = \"box\"\nspheres = [[0, 0, 0, 0.8]]"), suite_);
  context.add_reference(Rung::truth, 0);
  for (const int n : {16, 32})
    for (const Rung rung : {Rung::cube, Rung::spheres}) context.add_reference(rung, n);
  Parameters parameters;
  parameters.set("resolution", 16);
  const Score score = context.score(context.truth(), parameters);
  EXPECT_EQ(score.errors.at("truth").report.all.rmse, 0.0);

  ReferenceSettings settings;
  settings.truth_noise = suite_.truth_noise, settings.resolution = 16;
  const std::vector<bool> valid = valid_receivers(context.frame().receivers);
  const Reference truth = compute_reference(context.frame(), Rung::truth, settings);
  EXPECT_DOUBLE_EQ(score.errors.at("truth").noise, truth.noise(valid));
  EXPECT_GT(score.errors.at("truth").noise, 0.0);
  const Image cube = compute_reference(context.frame(), Rung::cube, settings).mean,
              spheres = compute_reference(context.frame(), Rung::spheres, settings).mean;
  EXPECT_DOUBLE_EQ(score.geometry.value(), rms(difference(spheres, cube), valid) / rms(cube, valid));
  EXPECT_NEAR(score.errors.at("cube").report.all.rmse, rms(difference(truth.mean, cube), valid), 1e-7);
  EXPECT_FALSE(context.score(context.truth(), {}).errors.at("cube").report.all.rmse ==
               score.errors.at("cube").report.all.rmse)
      << "32 where no resolution is asked for";
}

TEST_F(SceneContexts, SaysWhatIsOddAboutAScene) {
  const std::vector<Rung> all = {Rung::truth, Rung::cube, Rung::spheres};
  EXPECT_EQ(said(scene("mesh = \"box\"\nspheres = [[0, 0, 0, 0.9]]"), {Rung::truth}), "");
  const std::string beside = said(scene("mesh = \"box\"\nspheres = [[0, 3, 0, 2.5]]"), all);
  EXPECT_NE(beside.find("its 1 spheres miss the mesh: they alone put"), std::string::npos) << beside;
  const std::string large = said(scene("mesh = \"box\"", 0.05), {Rung::truth});
  EXPECT_NE(large.find("the mesh is 1.73 m across, its receivers 0.133 m"), std::string::npos) << large;
}

}  // namespace
}  // namespace penumbra
