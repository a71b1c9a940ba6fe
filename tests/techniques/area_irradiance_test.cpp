// Unshadowed light of lamps in closed form.
#include "techniques/bases/area_irradiance.h"

#include "techniques/bases/light_sampling.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// The same by midpoints on the lamp.
double sampled(const AreaLight& light, vec3 position, vec3 normal, int n = 400) {
  double sum = 0.0;
  for (int i = 0; i < n * n; ++i)
    sum +=
        double(sample_area(light, position, normal, (float(i % n) + 0.5f) / float(n), (float(i / n) + 0.5f) / float(n))
                   .weight.x);
  return sum / (n * n);
}

double factor(const AreaLight& light, vec3 position, vec3 normal) {
  return double(form_factor(make_polygon(light), position, normal));
}

const AreaLight square = make_rectangle({0, 1, 0}, {2, 0, 0}, {0, 0, 2}, vec3(1.0f));

TEST(AreaIrradiance, SquareAndParallelogramEqualTheirSamples) {
  const AreaLight skew = make_rectangle({0.3f, 2, -0.2f}, {1.5f, 0.2f, 0}, {0.5f, 0.1f, 1.0f}, vec3(1.0f));
  for (const AreaLight& light : {square, skew})
    for (const vec3 position : {vec3(0), vec3(1, 0, 0.5f), vec3(-3, 0, 2)})
      for (const vec3 normal : {vec3(0, 1, 0), vec3(0.6f, 0.8f, 0), vec3(0.8f, -0.6f, 0), vec3(0, 0, 1)})
        EXPECT_NEAR(factor(light, position, normal), sampled(light, position, normal), 2e-4)
            << position.x << " " << normal.x << " " << normal.y;
}

TEST(AreaIrradiance, ParallelEdgesGiveNothingNotRoundOff) {
  for (const AreaLight& light : {make_rectangle({0, 3, 0}, {0.1f, 0.2f, 0.3f}, {0.3f, 0.6f, 0.9f}, vec3(1.0f)),
                                 make_rectangle({1, 3, 2}, {1, 2, 3}, {3, 6, 9}, vec3(1.0f)),
                                 make_rectangle({0, 3, 0}, {0, 0, 0}, {0, 0, 1}, vec3(1.0f))})
    for (const vec3 position : {vec3(0), vec3(1, 0, 0.5f), vec3(-3, 0, 2)})
      EXPECT_EQ(factor(light, position, {0, 1, 0}), 0.0);
}

TEST(AreaIrradiance, DiscOnItsAxis) {
  for (const float radius : {0.1f, 1.0f, 3.0f}) {  // sin^2 of its angular radius
    const AreaLight disc = make_disc({0, 1, 0}, {0, -1, 0}, radius, vec3(1.0f));
    const double exact = double(radius * radius) / (1.0 + double(radius * radius));
    EXPECT_NEAR(factor(disc, vec3(0), {0, 1, 0}), exact, 1e-4 * exact + 2e-4 * exact * exact) << radius;
  }
}

TEST(AreaIrradiance, ASmallFarLampKeepsItsDigits) {
  const AreaLight far = make_rectangle({0, 100, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, vec3(1.0f));
  const double exact = 0.01 / (pi * 1e4);
  EXPECT_NEAR(factor(far, vec3(0), {0, 1, 0}), exact, 3e-3 * exact);
}

TEST(AreaIrradiance, BoundsOfWhatALampCanGive) {
  const AreaLight sky = make_rectangle({0, 0.01f, 0}, {100, 0, 0}, {0, 0, 100}, vec3(1.0f));
  EXPECT_NEAR(factor(sky, vec3(0), {0, 1, 0}), 1.0, 1e-4);
  EXPECT_EQ(factor(square, {0, 2, 0}, {0, -1, 0}), 0.0) << "behind the lamp";
  EXPECT_EQ(factor(square, vec3(0), {0, -1, 0}), 0.0) << "below the receiver's horizon";
  EXPECT_EQ(factor(square, vec3(NAN), {0, 1, 0}), 0.0);
  const AreaLight nothing = make_rectangle({0, 1, 0}, vec3(0), {0, 0, 1}, vec3(1.0f));
  EXPECT_EQ(factor(nothing, vec3(0), {0, 1, 0}), 0.0);
  EXPECT_TRUE(std::isfinite(factor(square, {1, 1, 1}, {0, 1, 0}))) << "on a corner";
}

}  // namespace
}  // namespace penumbra
