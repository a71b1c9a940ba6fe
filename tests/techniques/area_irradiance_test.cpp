// Unshadowed light of lamps in closed form.
#include "techniques/bases/area_irradiance.h"

#include <hwy/targets.h>

#include <algorithm>
#include <random>

#include "techniques/bases/light_sampling.h"
#include "techniques/bases/shadow_map/kernel.h"
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
  return double(form_factor(make_outline(light), position, normal));
}

const AreaLight square = make_rectangle({0, 1, 0}, {2, 0, 0}, {0, 0, 2}, vec3(1.0f));

TEST(AreaIrradiance, LampsEqualTheirSamples) {
  const AreaLight skew = make_rectangle({0.3f, 2, -0.2f}, {1.5f, 0.2f, 0}, {0.5f, 0.1f, 1.0f}, vec3(1.0f));
  const AreaLight disc = make_disc({0.2f, 1, 0}, {0.1f, -1, 0.3f}, 1.3f, vec3(1.0f));
  for (const AreaLight& light : {square, skew, disc})
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

// --- discs -----------------------------------------------------------------------------------------------------------

/// Nodes and weights of Gauss and Legendre on [-1, 1].
std::vector<std::pair<double, double>> gauss_legendre(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(pi * (double(i) + 0.75) / (double(n) + 0.5)), slope = 1.0;
    for (int step = 0; step < 8; ++step) {
      double before = 1.0, value = x;
      for (int k = 2; k <= n; ++k) {
        const double next = (double(2 * k - 1) * x * value - double(k - 1) * before) / double(k);
        before = value, value = next;
      }
      slope = double(n) * (x * value - before) / (x * x - 1.0);
      x -= value / slope;
    }
    rule.emplace_back(x, 2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

/// A disc as a receiver at the origin sees it; `lamp` is the side it shines to.
struct View {
  dvec3 to, lamp, normal;
  double radius;
};

/// cos cos / (pi distance^2) over what the horizon leaves of the disc: strips along the horizon, each of them in
/// points. As good as its rule where the plane is not much nearer than the radius over the number of nodes.
double integrated(const View& v) {
  static const auto rule = gauss_legendre(300);
  const dvec3 z = -v.lamp, lean = v.normal - glm::dot(v.normal, z) * z;
  const double slope = glm::length(lean);
  const dvec3 up = slope > 1e-9 ? lean / slope : glm::normalize(glm::cross(z, dvec3(z.y, z.z, -z.x) + dvec3(0.1)));
  const dvec3 along = glm::cross(z, up);
  const double edge =
      slope > 1e-9 ? -glm::dot(v.normal, v.to) / (v.radius * slope) : (glm::dot(v.normal, z) > 0 ? -1 : 1);
  const double last = std::acos(std::clamp(edge, -1.0, 1.0));
  double sum = 0.0;
  for (const auto& [a, weight] : rule) {
    const double angle = 0.5 * last * (a + 1.0), width = v.radius * std::sin(angle);
    for (const auto& [b, other] : rule) {
      const dvec3 x = v.to + v.radius * std::cos(angle) * up + width * b * along;
      const double d2 = glm::dot(x, x);
      sum += 0.5 * last * weight * other * width * width * glm::dot(v.normal, x) * glm::dot(z, x) / (pi * d2 * d2);
    }
  }
  return sum;
}

dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> along;
  return glm::normalize(dvec3(along(random), along(random), along(random)));
}

/// Near and far, on the axis and beside it, straight and tilted, one in three cut by the horizon.
View random_view(std::mt19937& random, int kind) {
  std::uniform_real_distribution<double> unit;
  View v;
  v.radius = std::exp(3.0 * unit(random) - 1.5);
  v.lamp = random_direction(random);
  const double h = v.radius * std::exp(8.0 * unit(random) - 3.0);
  const dvec3 aside = glm::normalize(glm::cross(v.lamp, random_direction(random)));
  const double beside = v.radius * std::exp(6.0 * unit(random) - 3.0);
  const double d = kind % 8 == 0 ? 0.0 : kind % 8 == 4 ? 1e-5 * beside : beside;
  v.to = -h * v.lamp + d * aside;
  v.normal = kind % 3 == 0 ? -v.lamp : random_direction(random);
  if (kind % 3 == 1) {  // the horizon passes through a point of the disc
    const dvec3 at = v.to + v.radius * (2.0 * unit(random) - 1.0) * aside;
    v.normal = glm::normalize(v.normal - glm::dot(v.normal, at) / glm::dot(at, at) * at);
  }
  return v;
}

TEST(AreaIrradiance, DiscsEqualTheirIntegral) {
  std::mt19937 random(5);
  int cut = 0;
  for (int k = 0; k < 240; ++k) {
    const View v = random_view(random, k);
    const double exact = integrated(v), facing = integrated({v.to, v.lamp, glm::normalize(v.to), v.radius});
    const dvec3 lean = v.normal - glm::dot(v.normal, v.lamp) * v.lamp;
    cut += std::abs(glm::dot(v.normal, v.to)) < v.radius * glm::length(lean);
    EXPECT_NEAR(disc_factor(v.to, v.lamp, v.normal, v.radius), exact, 1e-6 * exact + 1e-10 * facing) << k;
    EXPECT_NEAR(double(disc_factor(vec3(v.to), vec3(v.lamp), vec3(v.normal), float(v.radius))), exact, 1e-5 * facing)
        << k << ", in float";
  }
  EXPECT_GT(cut, 60);
}

TEST(AreaIrradiance, DiscOnItsAxis) {
  for (const float radius : {0.001f, 0.1f, 1.0f, 3.0f, 1000.0f}) {  // sin^2 of its angular radius
    const AreaLight disc = make_disc({0, 1, 0}, {0, -1, 0}, radius, vec3(1.0f));
    const double exact = double(radius) * double(radius) / (1.0 + double(radius) * double(radius));
    EXPECT_NEAR(factor(disc, vec3(0), {0, 1, 0}), exact, 1e-6 * exact) << radius;
  }
}

TEST(AreaIrradiance, DiscNearItsPlane) {
  const double r = double(0.7f);
  for (const float height : {0.1f, 0.03f, 0.01f, 1e-4f, 1e-6f}) {
    const AreaLight disc = make_disc({0, height, 0}, {0, -1, 0}, 0.7f, vec3(1.0f));
    for (const float d : {0.0f, 0.3f, 0.69f, 0.71f, 2.0f}) {
      const double d2 = double(d) * double(d), h2 = double(height) * double(height);
      const double exact = 0.5 * (1.0 - (d2 + h2 - r * r) / std::sqrt(std::pow(d2 + h2 + r * r, 2) - 4.0 * r * r * d2));
      EXPECT_NEAR(factor(disc, {0, 0, d}, {0, 1, 0}), exact, 1e-5 * exact + 1e-12) << height << " " << d;
      EXPECT_EQ(factor(disc, {0, 2 * height, d}, {0, 1, 0}), 0.0) << "behind the lamp";
      EXPECT_EQ(factor(disc, {0, 0, d}, {0, -1, 0}), 0.0) << "below the receiver's horizon";
    }
  }
}

TEST(AreaIrradiance, HalfADiscOnTheHorizon) {
  // On the axis, half of what a receiver sideways gets from both sides: alpha = 90 degrees, so that
  // E / (pi L) = (atan(r / h) - r h / (r^2 + h^2)) / pi.
  for (const float radius : {0.01f, 0.5f, 1.0f, 40.0f}) {
    const double r = double(radius), exact = (std::atan(r) - r / (1.0 + r * r)) / pi;
    const AreaLight disc = make_disc({0, 1, 0}, {0, -1, 0}, radius, vec3(1.0f));
    for (const vec3 normal : {vec3(1, 0, 0), vec3(0, 0, -1)})
      EXPECT_NEAR(factor(disc, vec3(0), normal), exact, 1e-6 * exact) << radius;
  }
}

TEST(AreaIrradiance, VectorsOfReceiversGetTheSame) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> place(-2.0f, 2.0f);
  for (const AreaLight& light : {make_disc({0.2f, 0.5f, 0}, {0.3f, -1, 0.1f}, 0.7f, vec3(1.0f)), square}) {
    const LampOutline outline = make_outline(light);
    Receivers r = test::receivers_at(std::vector<vec3>(1003));
    for (int i = 0; i < r.size(); ++i) {
      r.position[i] = vec3(place(random), 0.5f * place(random), place(random));
      r.normal[i] = i % 50 == 49 ? vec3(0.0f) : i % 3 ? vec3(random_direction(random)) : vec3(0, 1, 0);
    }
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      std::vector<float> found(std::size_t(r.size()), -1.0f);
      shadow_map::simd::find_unshadowed(outline, r, 0, 500, found.data());
      shadow_map::simd::find_unshadowed(outline, r, 500, r.size(), found.data());
      for (int i = 0; i < r.size(); ++i)
        EXPECT_NEAR(found[i], r.valid(i) ? form_factor(outline, r.position[i], r.normal[i]) : 0.0f, 2e-6f)
            << i << " on " << hwy::TargetName(target);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(AreaIrradiance, DiscsOfAnyUnit) {
  const AreaLight metre = make_disc({0.3f, 1, 0}, {0.2f, -1, 0}, 0.7f, vec3(1.0f));
  for (const float unit : {1e-12f, 1e-3f, 1e6f, 1e12f}) {
    const AreaLight disc = make_disc(unit * metre.centre, metre.normal, unit * 0.7f, vec3(1.0f));
    for (const vec3 normal : {vec3(0, 1, 0), vec3(0.96f, 0.28f, 0)})
      EXPECT_NEAR(factor(disc, vec3(0), normal) / factor(metre, vec3(0), normal), 1.0, 3e-6) << unit;
  }
  EXPECT_EQ(factor(make_disc({0, 1, 0}, {0, -1, 0}, 0.0f, vec3(1.0f)), vec3(0), {0, 1, 0}), 0.0);
  EXPECT_EQ(factor(metre, vec3(NAN), {0, 1, 0}), 0.0);
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
