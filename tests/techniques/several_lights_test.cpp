// Several lights: whatever shades each alone shades all; image, truth and scale are sums.
#include "techniques/several_lights.h"

#include "harness/catalogue/catalogue.h"
#include "harness/measure/black_truth.h"
#include "harness/measure/check.h"
#include "harness/measure/parity.h"
#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// A picture of a box under one environment and two lamps of different colours, or under one of these.
Scene lit_by(const std::string& lights) {
  const test::TemporaryFolder folder;
  return load_scene(
      folder.write("s.toml",
                   "[occluder]\nmesh = \"box\"\nfit = { height = 1.0, on_ground = true }\nspheres = [[0, 0, 0, 0.5]]\n"
                   "[receivers]\ncamera = { eye = [1.5, 2, 4], target = [0, 0.4, 0], width = 12, height = 10 }\n" +
                       lights));
}

const std::string environment = "[light]\nenvironment = \"lamps\"\n";
const std::string red =
    "[[light.area]]\ncentre = [1, 3, 1]\nedge_u = [0, 0, 0.5]\nedge_v = [-0.5, 0, 0]\nradiance = [40, 4, 0]\n";
const std::string blue =
    "[[light.area]]\ncentre = [-2, 2.5, 0.5]\nnormal = [1, -1, 0]\nradius = 0.3\nradiance = [0, 9, 50]\n";

TEST(SeveralLights, AreReadTogether) {
  const Scene all = lit_by(environment + red + blue);
  ASSERT_EQ(each_of(all.light).size(), 3u);
  EXPECT_NE(environment_of(each_of(all.light)[0]), nullptr);
  EXPECT_EQ(area_light_of(each_of(all.light)[2])->shape, AreaLight::Shape::disc);
  EXPECT_EQ(environment_of(all.light), nullptr) << "several are not one";
  EXPECT_EQ(each_of(lit_by(red).light).size(), 1u);
  EXPECT_NE(area_light_of(lit_by(red).light), nullptr);
}

/// Light by light, in a first light's random numbers: what `part` of one gets.
Parameters of_part(const Entry& entry, Parameters parameters, int part) {
  for (const Parameter& p : entry.parameters)
    if (p.name == "seed") parameters.set("seed", std::get<int>(p.fallback) + part);
  return parameters;
}

TEST(SeveralLights, ImagesAddUp) {
  const Scene all = lit_by(environment + red + blue);
  const Scene alone[] = {lit_by(environment), lit_by(red), lit_by(blue)}, lamps = lit_by(red + blue);
  const Registry registry = make_registry();
  int tried = 0;
  for (const Entry& entry : registry.entries()) {
    if (!entry.unavailable.empty()) continue;
    const Parameters small = test::small_parameters(entry);
    const Scene& several = entry.lights.environment ? all : lamps;
    if (!entry.lights.accepts(several.light)) {
      EXPECT_NE(reason_to_skip(entry, several.light), "");
      continue;
    }
    ++tried;
    std::vector<vec3> sum(std::size_t(all.receivers.size()), vec3(0.0f));
    int part = 0;
    for (const Scene& one : alone) {
      if (!entry.lights.accepts(one.light)) continue;
      const std::vector<vec3> image = test::shade(*make_technique(entry, of_part(entry, small, part++)), one);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += image[i];
    }
    EXPECT_LT(test::difference(test::shade(*make_technique(entry, small, several.light), several), sum), 1e-6)
        << entry.title();
  }
  EXPECT_GT(tried, 10) << "the shadow-map family, rays and the smallest technique";
}

TEST(SeveralLights, TruthsAddUp) {
  const Scene all = lit_by(environment + red + blue);
  ReferenceSettings settings;
  settings.truth_noise = 0.01;
  const auto truth = [&](const Scene& scene) {
    Animation animation(scene);
    return compute_reference(animation.frame(0), Rung::truth, settings);
  };
  // The samples of the second and third light are others than theirs alone; both sums are as uncertain.
  const std::vector<bool> valid = valid_receivers(all.receivers);
  for (const std::vector<std::string>& lights : {std::vector{environment, red, blue}, std::vector{red, blue}}) {
    std::string text;
    for (const std::string& light : lights) text += light;
    const Reference together = truth(lit_by(text));
    Reference parts = together;
    std::fill(parts.mean.pixels.begin(), parts.mean.pixels.end(), vec3(0.0f));
    std::fill(parts.variance.pixels.begin(), parts.variance.pixels.end(), vec3(0.0f));
    for (const std::string& light : lights) {
      const Reference one = truth(lit_by(light));
      for (std::size_t i = 0; i < valid.size(); ++i)
        parts.mean.pixels[i] += one.mean.pixels[i], parts.variance.pixels[i] += one.variance.pixels[i];
    }
    const double noise = std::hypot(together.noise(valid), parts.noise(valid));
    EXPECT_LT(rms(difference(together.mean, parts.mean), valid), 1.5 * noise);
    EXPECT_NEAR(together.noise(valid) / parts.noise(valid), 1.0, 0.3) << text;
  }

  Animation animation(all);
  const Frame frame = animation.frame(0);
  EXPECT_NE(inapplicable(frame, Rung::r13x13), "");
  EXPECT_NE(inapplicable(frame, Rung::cube), "");
  const Scene two = lit_by(red + blue);
  Animation of_lamps(two);
  EXPECT_EQ(inapplicable(of_lamps.frame(0), Rung::r13x13), "");
  const Receivers& r = all.receivers;
  EXPECT_GT(light_scale(all.light, r), light_scale(two.light, r));
  EXPECT_TRUE(light_arrives(all.light, r));
}

/// Equal lamps in one place are sampled apart: the noise of their sum is what its variance says.
TEST(SeveralLights, AreSampledIndependently) {
  std::string eight;
  for (int k = 0; k < 8; ++k) eight += blue;
  ReferenceSettings coarse;
  coarse.truth_noise = 0.05;
  const auto truth = [](const Scene& scene, const ReferenceSettings& settings) {
    Animation animation(scene);
    return compute_reference(animation.frame(0), Rung::truth, settings);
  };
  ReferenceSettings fine;
  fine.truth_noise = 0.002;
  const Scene one = lit_by(blue), all = lit_by(eight);
  const std::vector<bool> valid = valid_receivers(all.receivers);
  const Reference exact = truth(one, fine), found = truth(all, coarse);
  Image eightfold = exact.mean;
  for (vec3& pixel : eightfold.pixels) pixel *= 8.0f;
  const double error = rms(difference(found.mean, eightfold), valid);
  EXPECT_LT(error, 1.6 * std::hypot(found.noise(valid), 8.0 * exact.noise(valid)));
}

/// A motion turns every light.
TEST(SeveralLights, TurnTogether) {
  Scene all = lit_by(environment + red + blue);
  all.motion = {Motion::Kind::rotate_light, float(2 * pi), 4.0f, 4};
  Animation animation(all);
  const Light& turned = animation.frame(1).light;  // a quarter: +x goes to -z
  EXPECT_NEAR(environment_of(each_of(turned)[0])->rotation, pi / 2, 1e-6);
  EXPECT_LT(glm::distance(area_light_of(each_of(turned)[1])->centre, vec3(1, 3, -1)), 1e-5f);
  EXPECT_LT(glm::distance(area_light_of(each_of(turned)[2])->centre, vec3(0.5f, 2.5f, 2)), 1e-5f);
  const Registry registry = make_registry();
  const auto technique = make_technique(registry.find("ray-traced", "simd"), {}, all.light);
  technique->prepare(all);
  technique->update(animation.frame(1));
  std::vector<vec3> image(std::size_t(all.receivers.size()));
  technique->shade({image.data(), all.receivers.width, all.receivers.height});
  Scene there = all;
  there.light = animation.frame(1).light;
  EXPECT_EQ(test::shade(*make_technique(registry.find("ray-traced", "simd"), {}, there.light), there), image);
}

}  // namespace
}  // namespace penumbra
