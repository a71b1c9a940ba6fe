#include "harness/measure/black_truth.h"

#include "harness/catalogue/catalogue.h"
#include "harness/measure/parity.h"
#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Receivers plane() {
  return make_receivers({PlaneGrid{2.0f, 24, 0.0f}, vec3(1.0f)}, {});
}

/// Light from the lower half alone.
Environment from_below(float radiance) {
  Environment e{Mapping::lat_long, 32, 16, std::vector<vec3>(32 * 16, vec3(0.0f)), 0.0};
  for (int i = 32 * 8; i < 32 * 16; ++i) e.radiance[i] = vec3(radiance);
  return e;
}

Scene scene_under(Light light) {
  Scene scene = test::sphere_scene({{{0, 0.5f, 0}, 0.5f}}, plane());
  scene.light = std::move(light);
  return scene;
}

/// A lamp that shines to the receivers from within a closed box.
Scene blocked() {
  Scene scene = scene_under(make_disc({0, 3, 0}, {0, -1, 0}, 0.2f, vec3(1.0f)));
  scene.mesh = make_box({-0.5f, 2.5f, -0.5f}, {0.5f, 3.5f, 0.5f});
  return scene;
}

std::string note_of(const Scene& scene) {
  return black_note("x", scene.light, scene.receivers, light_arrives(scene.light, scene.receivers));
}

TEST(BlackTruth, LightScaleFollowsTheLight) {
  const Receivers receivers = plane();
  EXPECT_NEAR(light_scale(test::constant_environment(), receivers), 4.0, 1e-5) << "4 pi over pi";
  EXPECT_NEAR(light_scale(from_below(1.0f), receivers), 2.0, 1e-5) << "wherever it comes from";
  EXPECT_NEAR(light_scale(from_below(1e9f), receivers), 2e9, 1e4);
  EXPECT_NEAR(light_scale(from_below(1e-6f), receivers), 2e-6, 1e-11);
  const Receivers one = test::receivers_at({{0, 0, 0}});
  const AreaLight lamp = make_rectangle({0, 10, 0}, {0, 0, 2}, {3, 0, 0}, vec3(5.0f));
  EXPECT_NEAR(light_scale(lamp, one), 5.0 * 6.0 / (pi * 100.0), 1e-6) << "even if it shines to the other side";
  EXPECT_NEAR(light_scale(make_rectangle({0, 0.01f, 0}, {0, 0, 2}, {3, 0, 0}, vec3(5.0f)), one), 5.0, 1e-6);
  Receivers grey = one;
  grey.albedo[0] = vec3(0.5f);
  EXPECT_NEAR(light_scale(lamp, grey), 0.5 * light_scale(lamp, one), 1e-9);
}

TEST(BlackTruth, TheNoteSaysWhy) {
  const auto expect = [](const Scene& scene, const char* why) {
    EXPECT_NE(note_of(scene).find(why), std::string::npos) << note_of(scene) << " for " << why;
    EXPECT_EQ(note_of(scene).find("scene x: the truth is black: "), 0u);
  };
  expect(scene_under(make_disc({0, 3, 0}, {0, 1, 0}, 0.2f, vec3(1.0f))),
         "does the lamp face away? it shines along (0, 1, 0) from (0, 3, 0)");
  expect(scene_under(make_rectangle({0, 3, 0}, {0, 0, 1}, {1, 0, 0}, vec3(1.0f))), "face away");
  expect(scene_under(make_disc({0, -3, 0}, {0, -1, 0}, 0.2f, vec3(1.0f))), "face away");
  expect(scene_under(make_disc({0, 3, 0}, {0, -1, 0}, 0.0f, vec3(1.0f))), "no area");
  expect(scene_under(make_disc({0, 3, 0}, {0, -1, 0}, 0.2f, vec3(0.0f))), "radiance is 0");
  expect(scene_under(make_disc({0, 3, 0}, {0, -1, 0}, 1e-25f, vec3(1.0f))), "no float");
  expect(scene_under(test::constant_environment(vec3(0.0f))), "the environment is black");
  expect(scene_under(from_below(1.0f)), "below the receivers' horizons");
  expect(blocked(), "in the way of all of it");
  Scene scene = scene_under(test::constant_environment());
  for (vec3& albedo : scene.receivers.albedo) albedo = vec3(0.0f);
  expect(scene, "albedo");
  for (vec3& normal : scene.receivers.normal) normal = vec3(0.0f);
  expect(scene, "nothing is seen");
}

TEST(BlackTruth, LightArrivesWhereASingleReceiverSeesIt) {
  Scene scene = scene_under(from_below(1.0f));
  EXPECT_FALSE(light_arrives(scene.light, scene.receivers));
  scene.receivers.normal[400] = {1, 0, 0};
  EXPECT_TRUE(light_arrives(scene.light, scene.receivers));
  for (const float radiance : {1e-30f, 1e9f})
    EXPECT_TRUE(light_arrives(test::constant_environment(vec3(radiance)), scene.receivers)) << radiance;
}

TEST(BlackTruth, ReferencesOfTheDarkAreBlackAndOthersAreNot) {
  const auto is_black = [](const Scene& scene, Rung rung) {
    Animation animation(scene);
    const Frame frame = animation.frame(0);
    const Reference r = compute_reference(frame, rung, {});
    return !(rms(r.mean, valid_receivers(frame.receivers)) > black_level(frame.light, frame.receivers));
  };
  for (const float radiance : {1e-6f, 1.0f, 1e9f})
    for (const Rung rung : {Rung::truth, Rung::cube, Rung::spheres})
      EXPECT_TRUE(is_black(scene_under(from_below(radiance)), rung)) << radiance << " " << to_string(rung);
  EXPECT_TRUE(is_black(blocked(), Rung::truth));
  EXPECT_FALSE(is_black(scene_under(test::constant_environment(vec3(1e-20f))), Rung::cube));
  EXPECT_FALSE(is_black(scene_under(make_disc({0, 3, 0}, {0, -1, 0}, 1e-4f, vec3(1.0f))), Rung::truth));
}

/// Radiance of round-off size beside a scalar twin that is black.
class Nearly : public Technique {
 public:
  explicit Nearly(float share) : share_(share) {}
  void prepare(const Scene& scene, const Light& light) override {
    radiance_ = share_ * float(light_scale(light, scene.receivers));
  }
  void update(const Frame&) override {}
  void shade(View<vec3> radiance) override {
    for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] = vec3(radiance_);
  }
  Footprint footprint() const override { return {}; }

 private:
  float share_, radiance_ = 0.0f;
};

double parity_of(float share, const Scene& scene) {
  Registry registry;
  for (const bool twin : {true, false}) {
    Entry e;
    e.name = "nearly", e.backend = twin ? Backend::scalar : Backend::simd;
    e.make = [=](const Parameters&) { return std::make_unique<Nearly>(twin ? 0.0f : share); };
    registry.add(e);
  }
  return parity_with_scalar(registry, registry.find("nearly", "simd"), {}, scene);
}

TEST(BlackTruth, ParityHasAFloorThatScalesWithTheLight) {
  for (const float radiance : {1e-30f, 1e-6f, 1.0f, 1e9f}) {
    for (const Scene& scene :
         {scene_under(from_below(radiance)), scene_under(make_disc({0, 3, 0}, {0, 1, 0}, 0.2f, vec3(radiance)))}) {
      EXPECT_EQ(parity_of(0.0f, scene), 0.0);
      EXPECT_NEAR(parity_of(1e-8f, scene), 1e-6, 1e-8) << "round-off, at radiance " << radiance;
      EXPECT_NEAR(parity_of(1e-3f, scene), 0.1, 1e-3) << "a thousandth of the light is no round-off";
    }
  }
}

TEST(BlackTruth, EveryTechniquePassesParityInTheDark) {
  const Registry registry = make_registry();
  for (const float radiance : {1e-6f, 1e9f}) {
    const Scene scenes[] = {scene_under(from_below(radiance)), scene_under(test::constant_environment(vec3(0.0f))),
                            scene_under(make_disc({0, 3, 0}, {0, 1, 0}, 0.2f, vec3(radiance))), blocked()};
    for (const Scene& scene : scenes)
      for (const Entry& entry : registry.entries()) {
        if (entry.backend != Backend::simd || !entry.lights.accepts(scene.light)) continue;
        const Scene small = thinned(scene, 8);
        EXPECT_LE(parity_with_scalar(registry, entry, test::small_parameters(entry), small), entry.parity)
            << entry.title() << " " << radiance;
      }
  }
}

}  // namespace
}  // namespace penumbra
