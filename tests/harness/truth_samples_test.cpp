// Samples of the truth near lamps, and the truth that they make, against closed forms and plain integration.
#include "harness/measure/truth_samples.h"

#include <algorithm>
#include <cstring>
#include <random>

#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "scenes/ray_scene.h"
#include "techniques/bases/area_irradiance.h"
#include "tests/techniques/lamp_scenes.h"

namespace penumbra {
namespace {

AreaLight disc_at(float height, float unit = 1.0f) {
  return make_disc({0, unit * height, 0}, {0, -1, 0}, unit * 0.7f, vec3(1.0f));
}
AreaLight square_at(float height) {
  return make_rectangle({0, height, 0}, {1.4f, 0, 0}, {0, 0, 1.4f}, vec3(1.0f));
}

/// n x n receivers on a square of twice the lamp's width.
Receivers plane(int n, float unit = 1.0f, vec3 normal = {0, 1, 0}) {
  std::vector<vec3> positions;
  const auto along = [&](int k) { return unit * (2.0f * (float(k) + 0.5f) / float(n) - 1.0f); };
  for (int k = 0; k < n * n; ++k) positions.emplace_back(along(k % n), 0, along(k / n));
  return test::receivers_at(positions, normal);
}

Reference truth_of(const AreaLight& light, const Receivers& receivers, const Mesh& mesh = {},
                   ReferenceSettings settings = {}) {
  const Scene scene = test::lamp_scene(mesh, receivers, light);
  Animation animation(scene);
  return compute_reference(animation.frame(0), Rung::truth, settings);
}

/// RMS error over the stated noise, which is reached.
double expect_truth(const AreaLight& light, const Receivers& receivers, const std::string& what) {
  const Reference truth = truth_of(light, receivers);
  const LampOutline outline = make_outline(light);
  const std::vector<bool> valid(receivers.normal.size(), true);
  double squares = 0.0;
  for (int i = 0; i < receivers.size(); ++i) {
    const double exact = double(light.radiance.x * form_factor(outline, receivers.position[i], receivers.normal[i]));
    const double error = double(truth.mean.pixels[i].x) - exact;
    squares += error * error;
    EXPECT_NEAR(truth.mean.pixels[i].x, truth.unshadowed.pixels[i].x, 1e-6 * std::max(exact, 1e-3))
        << what << ", receiver " << i;
  }
  EXPECT_LE(truth.noise(valid), 0.002 * rms(truth.mean, valid)) << what;
  EXPECT_LT(truth.rays_per_receiver, 1 << 15) << what;
  return std::sqrt(squares / double(receivers.size())) / truth.noise(valid);
}

TEST(TruthSamples, ALampNearAPlaneMeetsTheClosedForm) {
  for (const float height : {0.3f, 0.1f, 0.03f, 0.01f, 1e-5f})
    for (const AreaLight& light : {disc_at(height), square_at(height)}) {
      const bool disc = light.shape == AreaLight::Shape::disc;
      const std::string what = (disc ? "disc at " : "square at ") + std::to_string(height);
      const double ratio = expect_truth(light, plane(32), what);
      EXPECT_GT(ratio, 0.8) << what;
      EXPECT_LT(ratio, 1.25) << what;
    }
}

TEST(TruthSamples, TiltedLampsAndReceiversMeetTheClosedForm) {
  const AreaLight lamps[] = {
      make_disc({0.2f, 0.4f, 0}, {0.5f, -1, 0.2f}, 0.7f, vec3(2.0f)),
      make_rectangle({0, 0.3f, 0}, {1.4f, 0.3f, 0}, {0.2f, -0.1f, 1.0f}, vec3(2.0f)),  // oblique
      make_rectangle({0, 0.05f, 0}, {6.0f, 0, 0}, {0, 0, 0.2f}, vec3(2.0f)),           // long
      make_disc({0.5f, 0, 0}, {-1, 0, 0}, 0.7f, vec3(2.0f)),                           // half below the horizon
  };
  for (const AreaLight& light : lamps)
    for (const vec3 normal : {vec3(0, 1, 0), vec3(0.8f, 0.6f, 0)}) {
      const std::string what = "lamp " + std::to_string(&light - lamps) + ", normal " + std::to_string(normal.x);
      const double ratio = expect_truth(light, plane(16, 1.0f, normal), what);
      EXPECT_GT(ratio, 0.75) << what;
      EXPECT_LT(ratio, 1.3) << what;
    }
}

/// What a receiver gets, by an even grid of the projected hemisphere, beside an occluder.
double integrated(const AreaLight& disc, const RayScene& rays, vec3 position, int n) {
  int open = 0;
  for (int k = 0; k < n * n; ++k) {
    const double square = (double(k % n) + 0.5) / n, angle = 2.0 * pi * (double(k / n) + 0.5) / n;
    const double sine = std::sqrt(square), up = std::sqrt(1.0 - square);
    const vec3 direction(float(sine * std::cos(angle)), float(up), float(sine * std::sin(angle)));
    const float distance = disc.centre.y / direction.y;
    if (glm::length(distance * vec3(direction.x, 0, direction.z) + position) > 0.7f) continue;
    open += !rays.occluded(position, direction, distance);
  }
  return double(open) / (double(n) * n);
}

TEST(TruthSamples, ShadowsBelowANearLamp) {
  const AreaLight disc = disc_at(0.1f);
  const Mesh ball = make_sphere({0.1f, 0.05f, 0}, 0.03f, 48);
  const RayScene rays(ball);
  std::vector<vec3> positions;
  for (int k = 0; k < 12; ++k) positions.emplace_back(0.08f * float(k), 0, 0.01f);
  const Reference truth = truth_of(disc, test::receivers_at(positions), ball, {32, 0.0005, 1 << 16});
  double darkest = 1.0;
  for (int i = 0; i < 12; ++i) {
    const double exact = integrated(disc, rays, positions[i], 700),
                 sigma = std::sqrt(double(truth.variance.pixels[i].x));
    EXPECT_NEAR(truth.mean.pixels[i].x, exact, 5.0 * sigma + 2e-4) << i;
    darkest = std::min(darkest, double(truth.mean.pixels[i].x / truth.unshadowed.pixels[i].x));
  }
  EXPECT_LT(darkest, 0.8) << "the ball casts a shadow";
}

TEST(TruthSamples, WeightsAreBounded) {
  for (const AreaLight& light : {disc_at(0.001f), square_at(0.001f)}) {
    const Light as_light = light;
    const TruthSamples samples(as_light);
    LightSampler::Scratch scratch;
    for (const vec3 position : {vec3(0), vec3(0.699f, 0, 0), vec3(0.72f, 0, 0)}) {
      const double share = samples.hemisphere_share(position);
      EXPECT_GT(share, 0.7);
      samples.draw(position, {0, 1, 0}, 4096, 1, scratch);
      for (const LightSample& s : scratch.samples) EXPECT_LE(double(s.weight.x), 1.001 / share);
    }
  }
}

TEST(TruthSamples, FarFromALampTheyArePlainOnes) {
  std::mt19937 random(3);
  std::normal_distribution<float> along;
  Environment sky;
  make_environment("sun-sky", sky);
  const Light lights[] = {sky, disc_at(0.0f), square_at(0.0f)};
  int far = 0;
  for (const Light& light : lights) {
    const LightSampler plain(light);
    const TruthSamples samples(light);
    LightSampler::Scratch a, b;
    for (std::uint64_t k = 0; k < 200; ++k) {
      const vec3 position(along(random), along(random), along(random));
      const vec3 normal = glm::normalize(vec3(along(random), along(random), along(random)));
      const bool near = area_light_of(light) && position.y < 0.0f && glm::length(position) < 0.7f;
      EXPECT_TRUE(!near || samples.hemisphere_share(position) > 0.0);
      if (samples.hemisphere_share(position) > 0.0) continue;
      plain.draw(position, normal, 256, k, a);
      samples.draw(position, normal, 256, k, b);
      ASSERT_EQ(a.samples.size(), b.samples.size());
      EXPECT_EQ(std::memcmp(a.samples.data(), b.samples.data(), 256 * sizeof(LightSample)), 0);
      ++far;
    }
  }
  EXPECT_GT(far, 300);
  const TruthSamples below(lights[1]);
  EXPECT_EQ(below.hemisphere_share({0, 0.1f, 0}), 0.0) << "behind the lamp";
  EXPECT_EQ(below.hemisphere_share({0, -0.71f, 0}), 0.0) << "farther than its radius";
}

TEST(TruthSamples, TheSameInAnyUnit) {
  for (const float unit : {1e-6f, 1e3f}) {
    const Light lights[] = {disc_at(0.1f), disc_at(0.1f, unit)};
    const TruthSamples metre(lights[0]), other(lights[1]);
    for (const vec3 position : {vec3(0), vec3(0.9f, 0, 0.2f), vec3(1.2f, 0, 0)})
      EXPECT_NEAR(other.hemisphere_share(unit * position), metre.hemisphere_share(position), 1e-6);
    const Reference a = truth_of(disc_at(0.1f), plane(16)), b = truth_of(disc_at(0.1f, unit), plane(16, unit));
    EXPECT_EQ(a.rays_per_receiver, b.rays_per_receiver);
    for (int i = 0; i < 256; ++i) EXPECT_NEAR(a.mean.pixels[i].x, b.mean.pixels[i].x, 0.01f) << unit << " " << i;
  }
}

}  // namespace
}  // namespace penumbra
