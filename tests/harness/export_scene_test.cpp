// Exported scenes hold all that an image depends on: a renderer that knows nothing else makes the same image.
#include "harness/measure/export_scene.h"

#include <fmt/format.h>

#include "harness/measure/foreign_image.h"
#include "harness/measure/scene_context.h"
#include "scenes/scene_file.h"
#include "tests/harness/exported_scene.h"
#include "tests/support.h"

namespace penumbra {
namespace {

class ExportedScenes : public testing::Test {
 protected:
  ExportedScenes() {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    Image light{32, 16, {}};  // bright on one side, so that turning it shows
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 32; ++x)
        light.pixels.emplace_back(x < 6 && y < 6 ? vec3(9.0f, 6.0f, 3.0f) : vec3(0.1f, 0.2f, 0.01f * float(x)));
    save_exr(folder_.path() + "/light.exr", light);
  }
  ~ExportedScenes() override { unsetenv("PENUMBRA_CACHE"); }

  std::string scene(const std::string& occluder, const std::string& receivers, const std::string& light,
                    const std::string& more = "") const {
    return folder_.write("scene.toml", "name = \"mine\"\n[occluder]\n" + occluder + "\n[receivers]\n" + receivers +
                                           "\nalbedo = [0.9, 0.5, 0.2]\n[light]\n" + light + "\n" + more);
  }

  /// Exports the scored frame, renders the files, and expects what chance makes of an exact image.
  nlohmann::json expect_same_image(const std::string& file, int samples) const {
    Suite suite;
    suite.truth_noise = 0.003;
    SceneContext context(load_scene(file), suite);
    const std::string out = folder_.path() + "/exported";
    export_scene(context.animation(), context.frame(), out);
    test::PlainRenderer renderer(out);
    Image variance;
    save_exr(folder_.path() + "/image.exr", renderer.render(samples, variance));
    const Image image = load_foreign_image(folder_.path() + "/image.exr", context.frame().receivers, "mine");
    context.add_reference(Rung::truth, 0);
    const RungErrors errors = context.score(image, {}).errors.at("truth");
    const std::vector<bool> valid = valid_receivers(context.frame().receivers);
    double noise = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < valid.size(); ++i)
      if (valid[i]) noise += double(variance.pixels[i].x + variance.pixels[i].y + variance.pixels[i].z) / 3.0, ++count;
    noise = std::sqrt(noise / double(count) + errors.noise * errors.noise);
    EXPECT_LT(errors.report.all.rmse, 1.4 * noise);
    EXPECT_GT(errors.report.all.rmse, 0.7 * noise);
    EXPECT_LT(noise, 0.02 * rms(context.truth(), valid)) << "else the test would see nothing";
    EXPECT_EQ(renderer.scene()["receivers"]["valid"], count);
    return renderer.scene();
  }

  test::TemporaryFolder folder_;
};

const char* plane = "plane = { half_extent = 1.5, resolution = 12, centre = [0.2, -1.0, 0.1] }";
const char* turned_light = "environment = \"light.exr\"\nrotation = 1.05";

TEST_F(ExportedScenes, AnEnvironmentOverAPlane) {
  const auto json = expect_same_image(scene("mesh = \"box\"", plane, turned_light), 24);
  EXPECT_EQ(json["receivers"]["kind"], "plane");
  EXPECT_TRUE(json["light"]["exact"]);
  EXPECT_NEAR(double(json["light"]["left_edge"]), pi + 1.05 - 5 * 2.0 * pi / 32, 1e-12);
  EXPECT_TRUE(json["spheres"].is_null());
}

TEST_F(ExportedScenes, CubeMapsAreResampled) {
  const auto json = expect_same_image(scene("mesh = \"box\"", plane, "environment = \"constant\""), 1);
  EXPECT_FALSE(json["light"]["exact"]);
  EXPECT_EQ(json["light"]["width"], 256);
}

TEST_F(ExportedScenes, ACameraThatSeesMeshGroundAndNothing) {
  const auto json = expect_same_image(
      scene("mesh = \"box\"\nfit = { height = 1.0, on_ground = true }",
            "camera = { eye = [1.5, 1.6, 2.5], target = [0, 1.0, 0], width = 14, height = 10 }", turned_light),
      24);
  EXPECT_LT(int(json["receivers"]["valid"]), 140);
  EXPECT_GT(int(json["receivers"]["valid"]), 60);
  EXPECT_EQ(json["receivers"]["eye"][1], 1.6f);
}

TEST_F(ExportedScenes, LampsAndVertices) {
  const char* rectangle =
      "area = { centre = [0.5, 3, 0.2], edge_u = [1.5, 0, 0], edge_v = [0, 0.3, 0.8], radiance = [3, 2, 1] }";
  const char* disc = "area = { centre = [0.5, 3, 0.2], normal = [0.1, -1, 0.2], radius = 0.8, radiance = [3, 2, 1] }";
  EXPECT_EQ(expect_same_image(scene("mesh = \"two-blockers\"", "plane = { half_extent = 1.5, resolution = 12 }", disc),
                              120)["light"]["kind"],
            "disc");
  const auto json = expect_same_image(scene("mesh = \"box\"", "vertices = true", rectangle), 120);
  EXPECT_EQ(json["light"]["kind"], "rectangle");
  EXPECT_EQ(json["image"]["height"], 1);
}

TEST_F(ExportedScenes, TheScoredFrameOfAMotionFarFromZero) {
  const auto json = expect_same_image(
      scene("mesh = \"box\"\nfit = { at = [80000, 0, 0] }\nspheres = [[0, 0, 0, 1]]",
            "plane = { half_extent = 1.5, resolution = 12, centre = [80000.2, -1.0, 0.1] }", turned_light,
            "[motion]\nkind = \"twist\"\namount = 1.5\nframes = 12\nperiod = 12\ncentre = [80000, 0, 0]\n"),
      24);
  EXPECT_EQ(json["frame"], 4);
  EXPECT_EQ(json["frames"], 12);
  EXPECT_NEAR(double(json["origin"][0]), 80000.0, 8.0);
  EXPECT_EQ(json["spheres"]["count"], 1);
  EXPECT_EQ(load_spheres(folder_.path() + "/exported/spheres.json").size(), 1u);
}

TEST_F(ExportedScenes, BothFormsOfReceiversAndLightHoldTheSame) {
  const Scene s = load_scene(scene("mesh = \"box\"", plane, turned_light));
  Animation animation(s);
  const std::string out = folder_.path() + "/exported";
  export_scene(animation, animation.frame(0), out);
  const ChannelImage image = load_channels(out + "/receivers.exr");
  const test::PlainPly points(out + "/receivers.ply");
  const auto channel = [&](const std::string& name, std::size_t i) {
    const auto at = std::find(image.channels.begin(), image.channels.end(), name) - image.channels.begin();
    return image.values.at(i * image.channels.size() + std::size_t(at));
  };
  ASSERT_EQ(points.size(), 144u);
  for (const std::size_t i : {0u, 17u, 143u}) {
    EXPECT_EQ(channel("P.X", i), s.receivers.position[i].x);
    EXPECT_EQ(channel("N.Y", i), 1.0f);
    EXPECT_EQ(channel("albedo.B", i), 0.2f);
    EXPECT_EQ(points.properties.at("z")[i], s.receivers.position[i].z);
    EXPECT_EQ(points.properties.at("ray_y")[i], channel("ray.Y", i));
  }
  EXPECT_EQ(load_image(out + "/light.pfm").pixels, load_image(out + "/light.exr").pixels);
  EXPECT_EQ(load_mesh(out + "/mesh.ply").triangles.size(), s.mesh.triangles.size());
}

TEST_F(ExportedScenes, FoldersThatCannotBeMadeAreAnError) {
  const Scene s = load_scene(scene("mesh = \"box\"", plane, turned_light));
  Animation animation(s);
  const std::string file = folder_.write("file", "");
  EXPECT_NE(test::error_of([&] { export_scene(animation, animation.frame(0), file + "/x"); }).find("cannot be made"),
            std::string::npos);
}

}  // namespace
}  // namespace penumbra
