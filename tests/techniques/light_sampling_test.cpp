#include "techniques/bases/light_sampling.h"

#include <algorithm>

#include "scenes/ray_scene.h"
#include "tests/support.h"

namespace penumbra {
namespace {

vec3 mean_weight(const LightSampler& sampler, vec3 position, vec3 normal, int k, std::uint64_t stream = 1) {
  LightSampler::Scratch scratch;
  sampler.draw(position, normal, k, stream, scratch);
  return estimate_radiance(RayScene{Mesh{}}, position, scratch.samples);
}

TEST(LightSampling, ConstantEnvironmentGivesOne) {
  const Light light = test::constant_environment();
  const LightSampler sampler(light);
  for (const vec3 n : {vec3(0, 1, 0), glm::normalize(vec3(1, -2, 0.5f))})
    EXPECT_NEAR(mean_weight(sampler, vec3(0.0f), n, 20000).x, 1.0f, 2e-3f);
  EXPECT_NEAR(sampler.unshadowed({0, 1, 0}).x, 1.0f, 1e-3f);
}

TEST(LightSampling, SunAndLampsAreUnbiased) {
  for (const char* name : {"sun-sky", "lamps"}) {
    Environment e;
    ASSERT_TRUE(make_environment(name, e));
    const vec3 exact = EnvironmentSampler(e).unshadowed(glm::normalize(vec3(0.2f, 1, 0.3f)));
    const Light light = e;
    const vec3 mean = mean_weight(LightSampler(light), vec3(0.0f), glm::normalize(vec3(0.2f, 1, 0.3f)), 200000);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / exact[c], 1.0f, 4e-3f) << name;
  }
}

TEST(LightSampling, DimTexelsBesideASunKeepTheirShare) {
  Environment e;
  make_environment("constant", e);
  e.radiance[(2 * 64 + 30) * 64 + 30] = vec3(1e6f);
  const Light light = e;
  const LightSampler sampler(light);
  LightSampler::Scratch scratch;
  sampler.draw(vec3(0.0f), {0, 1, 0}, 1 << 20, 5, scratch);
  double dim = 0.0;
  for (const LightSample& s : scratch.samples)
    if (s.weight.x > 0 && cube_texel(s.direction, 64) != (2 * 64 + 30) * 64 + 30) dim += double(s.weight.x);
  EXPECT_NEAR(dim / (1 << 20), 1.0, 0.1);
}

TEST(LightSampling, RotationTurnsTheSamples) {
  Environment e;
  make_environment("sun-sky", e);
  const Light rest = e;
  e.rotation = 2.0;
  const Light turned = e;
  const LightSampler a(rest), b(turned);
  LightSampler::Scratch sa, sb;
  a.draw(vec3(0.0f), {0, 1, 0}, 64, 9, sa);
  b.draw(vec3(0.0f), {0, 1, 0}, 64, 9, sb);
  double share = 0.0;
  for (int i = 0; i < 64; ++i) {
    const vec3 d = sa.samples[i].direction;
    const vec3 turned_d(std::cos(2.0f) * d.x + std::sin(2.0f) * d.z, d.y, std::cos(2.0f) * d.z - std::sin(2.0f) * d.x);
    share += glm::length(turned_d - sb.samples[i].direction) < 1e-4f;
  }
  EXPECT_GT(share, 60);  // a sample may fall to the other side of a cell border by rounding
}

/// Equal strata of the sky in every set: how many of its samples lie to one side hardly varies. At random it would by
/// half the root of their number.
TEST(LightSampling, SamplesOfASkyAreSpread) {
  const Light light = test::constant_environment();
  const LightSampler sampler(light);
  LightSampler::Scratch scratch;
  constexpr int count = 256, sets = 64;
  double squared[2] = {};
  for (int set = 0; set < sets; ++set) {
    sampler.draw(vec3(0.0f), {0, 1, 0}, count, std::uint64_t(set), scratch);
    int side[2] = {};
    for (const LightSample& s : scratch.samples) side[0] += s.direction.x > 0.0f, side[1] += s.direction.z > 0.0f;
    for (int k = 0; k < 2; ++k) squared[k] += std::pow(side[k] - count / 2, 2) / sets;
  }
  for (const double s : squared) EXPECT_LT(std::sqrt(s), 0.5 * 0.5 * std::sqrt(count));
}

/// Hammersley points, shifted anew in every set: along either edge a lamp's points lie 1 / k apart.
TEST(LightSampling, PointsOnALampAreEvenAlongBothEdges) {
  const AreaLight lamp = make_rectangle({0, 1, 0}, {2, 0, 0}, {0, 0, 3}, vec3(1.0f));
  const Light light = lamp;
  const LightSampler sampler(light);
  LightSampler::Scratch scratch;
  std::vector<float> first;
  for (const std::uint64_t stream : {1u, 2u}) {
    sampler.draw(vec3(0.0f), {0, 1, 0}, 64, stream, scratch);
    std::vector<float> along[2];
    for (const LightSample& s : scratch.samples) {
      const vec3 p = s.distance * s.direction;
      along[0].push_back(p.x / 2.0f + 0.5f), along[1].push_back(p.z / 3.0f + 0.5f);
    }
    first.push_back(along[0][0]);
    for (std::vector<float>& places : along) {
      std::sort(places.begin(), places.end());
      for (std::size_t i = 1; i < places.size(); ++i) EXPECT_NEAR(places[i] - places[i - 1], 1.0f / 64.0f, 1e-5f);
    }
  }
  EXPECT_GT(std::abs(first[0] - first[1]), 1e-3f) << "every set has a shift of its own";
}

TEST(LightSampling, BlackLightGivesNothing) {
  const Light light = test::constant_environment(vec3(0.0f));
  EXPECT_EQ(mean_weight(LightSampler(light), vec3(0.0f), {0, 1, 0}, 16), vec3(0.0f));
}

// Lambert's formula: irradiance from a polygon is the sum over edges of angle x (edge normal . N) / 2.
double polygon_irradiance(const std::vector<dvec3>& corners, dvec3 normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const dvec3 a = glm::normalize(corners[i]), b = glm::normalize(corners[(i + 1) % corners.size()]);
    sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), normal);
  }
  return std::abs(sum) / 2;
}

TEST(LightSampling, RectangleFollowsLambert) {
  const AreaLight light = make_rectangle({0.5f, 2, 0.3f}, {1.5f, 0, 0}, {0, 0.3f, 1}, vec3(3.0f));
  const Light as_light = light;
  const std::vector<dvec3> corners = {dvec3(light.point(0, 0)), dvec3(light.point(1, 0)), dvec3(light.point(1, 1)),
                                      dvec3(light.point(0, 1))};
  const double exact = 3 * polygon_irradiance(corners, {0, 1, 0}) / pi;
  EXPECT_NEAR(double(mean_weight(LightSampler(as_light), vec3(0.0f), {0, 1, 0}, 4096).x) / exact, 1.0, 1e-3);
}

TEST(LightSampling, DiscOverhead) {
  const Light light = make_disc({0, 2, 0}, {0, -1, 0}, 1.0f, vec3(1.0f));
  EXPECT_NEAR(mean_weight(LightSampler(light), vec3(0.0f), {0, 1, 0}, 4096).x, 1.0f / 5.0f,
              2e-4f);  // R^2 / (R^2 + h^2)
}

TEST(LightSampling, LightsShineToOneSide) {
  const Light away = make_disc({0, 2, 0}, {0, 1, 0}, 1.0f, vec3(1.0f));
  EXPECT_EQ(mean_weight(LightSampler(away), vec3(0.0f), {0, 1, 0}, 64), vec3(0.0f));
  const Light below = make_disc({0, -2, 0}, {0, 1, 0}, 1.0f, vec3(1.0f));
  EXPECT_EQ(mean_weight(LightSampler(below), vec3(0.0f), {0, 1, 0}, 64), vec3(0.0f));
  const Light here = make_disc({0, 0, 0}, {0, 1, 0}, 0.0f, vec3(1.0f));
  EXPECT_EQ(mean_weight(LightSampler(here), vec3(0.0f), {0, 1, 0}, 64), vec3(0.0f));
}

TEST(LightSampling, NormalisedSamplesGiveTheExactUnshadowedLight) {
  Environment e;
  make_environment("lamps", e);
  const Light light = e;
  const LightSampler sampler(light);
  LightSampler::Scratch scratch;
  sampler.draw(vec3(0.0f), {0, 1, 0}, 7, 3, scratch);
  const vec3 exact = sampler.unshadowed({0, 1, 0});
  LightSampler::normalise(exact, scratch.samples);
  const vec3 mean = estimate_radiance(RayScene{Mesh{}}, vec3(0.0f), scratch.samples);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / exact[c], 1.0f, 1e-5f);
}

}  // namespace
}  // namespace penumbra
