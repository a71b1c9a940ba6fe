// An exact technique is a tie with the truth: rays by the ten thousand on a dozen small scenes.
#include <fmt/format.h>

#include "harness/catalogue/catalogue.h"
#include "harness/measure/check.h"
#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

struct Small {
  const char *mesh, *receivers, *light;
};

constexpr const char* plane = "plane = { half_extent = 1.5, resolution = 24, y = -1.0 }";
constexpr const char* camera =
    "camera = { eye = [2, 2, 3], target = [0, -0.3, 0], width = 32, height = 24, ground = -1.0 }";
constexpr const char* lamp =
    "area = { centre = [0.5, 3, 0], edge_u = [1, 0, 0], edge_v = [0, 0, 1], radiance = [5, 4, 3] }";
constexpr const char* disc = "area = { centre = [-1, 2, 0], normal = [0.4, -1, 0], radius = 0.6 }";

constexpr Small scenes[] = {
    {"box", plane, "environment = \"constant\""},
    {"sphere", plane, "environment = \"sun-sky\""},
    {"torus-knot", plane, "environment = \"lamps\""},
    {"bowl", plane, "environment = \"softbox\""},
    {"box", plane, lamp},
    {"sphere", plane, lamp},
    {"torus-knot", plane, disc},
    {"bowl", plane, disc},
    {"box", camera, "environment = \"sun-sky\""},
    {"torus-knot", camera, "environment = \"constant\""},
    {"sphere", camera, lamp},
    {"torus-knot", camera, disc},
};

/// Relative error against truth, and what makes a tie.
RungErrors measured(const Small& small, const Suite& suite, const Registry& registry) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write(
      "scene.toml", fmt::format("name = \"small\"\n[occluder]\nmesh = \"{}\"\n[receivers]\n{}\n[light]\n{}\n",
                                small.mesh, small.receivers, small.light));
  SceneContext context(load_scene(file), suite);
  context.add_reference(Rung::truth, 0);
  const Checked exact = check(suite.variants[0], context, suite, registry, "");
  EXPECT_TRUE(exact.row.ok()) << exact.row.status;
  return exact.row.score.errors.at("truth");
}

TEST(Ties, AnExactTechniqueIsATie) {
  const test::TemporaryFolder cache;
  setenv("PENUMBRA_CACHE", cache.path().c_str(), 1);
  const Registry registry = make_registry();
  Suite suite;
  suite.truth_noise = 0.01;
  Parameters given;
  given.set("rays", 65536);
  const Entry& entry = registry.find("ray-traced", "simd");
  suite.variants = {{&entry, given.resolve(entry.parameters, "ray-traced"), 2}};
  int ties = 0;
  for (const Small& small : scenes) {
    const RungErrors truth = measured(small, suite, registry);
    const double ratio = truth.report.all.rel_rmse.value() / truth.rel_noise.value();
    ties += truth.tie();
    EXPECT_GT(ratio, 0.6) << small.mesh << " " << small.light << ": the truth is better than it says";
    RecordProperty(std::string(small.mesh) + " " + small.light, fmt::format("{:.2f}", ratio));
  }
  unsetenv("PENUMBRA_CACHE");
  EXPECT_GE(ties, 11) << "of 12";
}

}  // namespace
}  // namespace penumbra
