// Scenes whose answer is known in closed form, for every way of finding blocked texels.
#include <algorithm>
#include <set>

#include "scenes/cube_map.h"
#include "techniques/bases/pixel_sum.h"
#include "tests/support.h"

namespace penumbra {
namespace {

struct Way {
  std::string backend;
  std::vector<std::string> parameters;
  double cap_tolerance, resting_tolerance;
  bool mesh;  ///< sees the mesh, so there is no receiver inside a sphere that is not inside the mesh
  friend void PrintTo(const Way& w, std::ostream* out) { *out << w.backend << " " << w.parameters[0]; }
};

/// The discretised 1 of the way's resolution.
double unoccluded_at(int n) {
  return double(pixel_sum(CubeLight(CubeMap<vec3>(n, vec3(1.0f))), BitCube(n), {0, 1, 0}, vec3(1.0f)).x);
}

class HardCases : public testing::TestWithParam<Way> {
 protected:
  double e(const std::vector<Sphere>& spheres, vec3 normal = {0, 1, 0}, vec3 x = vec3(0.0f)) const {
    return double(test::shade("pixel-basis", GetParam().backend, GetParam().parameters,
                              test::sphere_scene(spheres, test::receivers_at({x}, normal)))[0]
                      .x);
  }
  static double unoccluded() {
    const auto& p = GetParam().parameters;
    return unoccluded_at(p.size() > 1 ? std::stoi(p[1].substr(p[1].find('=') + 1)) : 32);
  }
};

/// Blocked fraction of one cap of angular radius sigma, tilted by gamma from the normal (algorithms 9).
double blocked_fraction(double sigma, double gamma) {
  if (gamma + sigma <= pi / 2) return std::sin(sigma) * std::sin(sigma) * std::cos(gamma);
  if (gamma - sigma >= pi / 2) return 0.0;
  const double x = 1 / std::tan(sigma), y = -x / std::tan(gamma), z = std::sin(gamma) * std::sqrt(1 - y * y);
  return ((std::cos(gamma) * std::acos(y) - x * z) * std::sin(sigma) * std::sin(sigma) + std::atan(z / x)) / pi;
}

vec3 tilted(double gamma, double azimuth = 0.7) {
  return {std::sin(gamma) * std::sin(azimuth), std::cos(gamma), std::sin(gamma) * std::cos(azimuth)};
}

TEST_P(HardCases, ReceiverInsideASphere) {  // 1
  EXPECT_EQ(e({{{0, 0.2f, 0}, 1.0f}}), 0.0);
  if (!GetParam().mesh) EXPECT_EQ(e({{{0, 0, 0}, 1.0f}}), 0.0);
}

TEST_P(HardCases, CapOnAxis) {  // 2
  for (double theta = 0.1; theta < 1.5; theta += 0.1)
    EXPECT_NEAR(e({test::cap_sphere({0, 1, 0}, theta)}), 1 - std::pow(std::sin(theta), 2), GetParam().cap_tolerance)
        << theta;
}

TEST_P(HardCases, CapTouchingTheHorizon) {  // 3
  for (double theta = 0.1; theta < 1.5; theta += 0.2)
    EXPECT_NEAR(e({test::cap_sphere(tilted(pi / 2 - theta), theta)}), 1 - std::pow(std::sin(theta), 3),
                GetParam().cap_tolerance);
}

TEST_P(HardCases, SphereRestingOnThePlane) {  // 4
  for (const float offset : {0.3f, 0.5f, 1.0f, 2.0f, 4.0f}) {
    const float radius = 0.5f;
    const double exact = 1 - std::pow(1 + double(offset * offset / (radius * radius)), -1.5);
    EXPECT_NEAR(e({{{offset, radius, 0}, radius}}), exact, GetParam().resting_tolerance) << offset;
  }
}

TEST_P(HardCases, CentreOnTheHorizon) {  // 5
  for (double sigma = 0.1; sigma < 1.5; sigma += 0.2)
    EXPECT_NEAR(e({test::cap_sphere(tilted(pi / 2), sigma)}), 1 - (sigma - std::sin(sigma) * std::cos(sigma)) / pi,
                GetParam().cap_tolerance);
}

TEST_P(HardCases, SphereBelowTheHorizon) {  // 6
  EXPECT_NEAR(e({{{0.3f, -2, 0.1f}, 1.0f}}), unoccluded(), 2e-6);
}

TEST_P(HardCases, AlmostTouching) {  // 7
  if (GetParam().mesh || GetParam().parameters[0] == "visibility=table") GTEST_SKIP() << "needs the exact cap";
  const float r = 1 - 1e-6f;
  EXPECT_NEAR(e({{{0, 1, 0}, r}}), 0.0, 1e-6);
  EXPECT_NEAR(e({{{1, 0, 0}, r}}), 0.5 * unoccluded(), 1e-5);  // 0.50016 at n = 32
  EXPECT_NEAR(e({{{0, -1, 0}, r}}), unoccluded(), 1e-5);
}

TEST_P(HardCases, OppositeSpheresLeaveNothing) {  // 8
  if (GetParam().mesh || GetParam().parameters[0] == "visibility=table") GTEST_SKIP() << "needs the exact cap";
  EXPECT_NEAR(e({{{0, 0, 1}, 1 - 1e-6f}, {{0, 0, -1}, 1 - 1e-6f}}), 0.0, 1e-6);
}

TEST_P(HardCases, DisjointCapsAdd) {  // 11
  const std::vector<Sphere> caps = {test::cap_sphere(tilted(0.2, 0), 0.2), test::cap_sphere(tilted(0.8, 1.5), 0.3),
                                    test::cap_sphere(tilted(0.9, 4.0), 0.25)};
  const double exact = 1 - (std::pow(std::sin(0.2), 2) * std::cos(0.2) + std::pow(std::sin(0.3), 2) * std::cos(0.8) +
                            std::pow(std::sin(0.25), 2) * std::cos(0.9));
  EXPECT_NEAR(e(caps), exact, 1.5 * GetParam().cap_tolerance);
}

TEST_P(HardCases, NestedCapsCountOnce) {  // 12
  const Sphere inner = test::cap_sphere(tilted(0.5), 0.2), outer = test::cap_sphere(tilted(0.5), 0.6);
  EXPECT_EQ(e({inner, outer}), e({outer}));
}

TEST_P(HardCases, TiltedCaps) {
  for (double gamma = 0.1; gamma < 2.4; gamma += 0.23)
    EXPECT_NEAR(e({test::cap_sphere(tilted(gamma), 0.6)}), 1 - blocked_fraction(0.6, gamma), GetParam().cap_tolerance)
        << gamma;
}

TEST_P(HardCases, NormalsOfTheirOwn) {
  const vec3 normal = glm::normalize(vec3(1, 2, -0.5f));
  vec3 t, b;
  orthonormal_frame(normal, t, b);
  for (const double gamma : {0.0, 0.5, 1.2}) {
    const vec3 v = float(std::cos(gamma)) * normal + float(std::sin(gamma)) * t;
    EXPECT_NEAR(e({test::cap_sphere(v, 0.5)}, normal), 1 - blocked_fraction(0.5, gamma), GetParam().cap_tolerance);
  }
}

TEST_P(HardCases, BlockedSunLeavesNoResidue) {  // 17
  for (const float sun : {1e6f, 1e9f}) {
    Scene scene = test::sphere_scene({test::cap_sphere({0, 1, 0.1f}, 0.4)}, test::receivers_at({vec3(0.0f)}));
    const auto shaded = [&] {
      return test::shade("pixel-basis", GetParam().backend, GetParam().parameters, scene)[0].x;
    };
    const float dark = shaded();
    // The source is a 64 x 64 cube: these four texels make one texel of 32 x 32, in the middle of the cap.
    auto& radiance = std::get<Environment>(scene.light).radiance;
    for (const int row : {32, 33})
      for (const int column : {32, 33}) radiance[(2 * 64 + row) * 64 + column] = vec3(sun);
    EXPECT_NEAR(shaded() / dark, 1.0f, 1e-6f) << sun;
  }
}

TEST_P(HardCases, NoOccluderIsTheDiscretisedOne) {
  EXPECT_NEAR(e({{{0, -50, 0}, 1.0f}}), unoccluded(), 2e-6);
}

// 38: an emitter of angular radius asin(R / d) on black gives B = albedo L (R / d)^2 cos(gamma).
TEST_P(HardCases, DistantSphericalEmitter) {
  Scene scene = test::sphere_scene({{{0, -50, 0}, 1.0f}}, test::receivers_at({vec3(0.0f)}));
  Environment& light = std::get<Environment>(scene.light);
  const vec3 v = tilted(0.6);
  for (int t = 0; t < int(light.radiance.size()); ++t)
    light.radiance[t] = vec3(glm::dot(light.direction(t, 0.5f, 0.5f), v) >= std::cos(0.3f) ? 5.0f : 0.0f);
  const float b = test::shade("pixel-basis", GetParam().backend, GetParam().parameters, scene)[0].x;
  EXPECT_NEAR(b / (5 * std::pow(std::sin(0.3), 2) * std::cos(0.6)), 1.0, 0.02);
}

INSTANTIATE_TEST_SUITE_P(EveryWay, HardCases,
                         testing::Values(Way{"scalar", {"visibility=raster"}, 0.012, 0.005, false},
                                         Way{"simd", {"visibility=raster"}, 0.012, 0.005, false},
                                         Way{"scalar", {"visibility=rays"}, 0.013, 0.006, true},
                                         Way{"simd", {"visibility=rays"}, 0.013, 0.006, true},
                                         // 2.53 degrees of direction and 1.4 of radius: the table's own error
                                         Way{"scalar", {"visibility=table"}, 0.06, 0.06, false},
                                         Way{"simd", {"visibility=table"}, 0.06, 0.06, false},
                                         Way{"simd", {"visibility=raster", "resolution=64"}, 0.006, 0.003, false},
                                         Way{"simd", {"visibility=raster", "resolution=16"}, 0.025, 0.012, false}));

TEST(PixelSum, UnoccludedConverges) {
  EXPECT_NEAR(unoccluded_at(32), 1.000320, 1e-6);
  EXPECT_NEAR(unoccluded_at(128), 1.000020, 1e-6);
}

TEST(PixelSum, NanBehindABlockedTexelIsNotSeen) {
  CubeMap<vec3> light(16, vec3(1.0f));
  light.texels[2 * 256 + 100] = vec3(NAN);
  BitCube blocked(16);
  EXPECT_TRUE(std::isnan(pixel_sum(CubeLight(light), blocked, {0, 1, 0}, vec3(1.0f)).x));
  blocked.set(2 * 256 + 100);
  EXPECT_FALSE(std::isnan(pixel_sum(CubeLight(light), blocked, {0, 1, 0}, vec3(1.0f)).x));
}

/// Rays that meet the spheres themselves: what the error of a fit is measured with.
TEST(RayTracedSpheres, CapAndRestingSphereComeNearTheirClosedForms) {
  for (const char* backend : {"scalar", "simd"}) {
    const auto e = [&](const Sphere& sphere) {
      Scene scene = test::sphere_scene({sphere}, test::receivers_at({vec3(0.0f)}));
      scene.mesh = make_box(vec3(50.0f), vec3(51.0f));  // out of sight: only the spheres count
      return double(test::shade("ray-traced", backend, {"rays=16384", "occluder=spheres"}, scene)[0].x);
    };
    for (const double theta : {0.2, 0.7, 1.2})
      EXPECT_NEAR(e(test::cap_sphere({0, 1, 0}, theta)), 1.0 - std::pow(std::sin(theta), 2), 3e-3) << theta;
    EXPECT_NEAR(e({{1.0f, 0.5f, 0.0f}, 0.5f}), 1.0 - std::pow(5.0, -1.5), 3e-3);
    EXPECT_EQ(e({{0.1f, 0.2f, 0.0f}, 1.0f}), 0.0) << "inside the sphere";
  }
}

/// Sixty-four receivers at one place: 8 x 8 sets of directions, each used once, and others for another seed.
TEST(RayTraced, NeighboursUseSetsOfTheirOwn) {
  Scene scene = test::sphere_scene({test::cap_sphere({0.3f, 1, 0.1f}, 0.6)}, {});
  Environment softbox;
  make_environment("softbox", softbox);
  scene.light = softbox;
  scene.receivers = test::receivers_at(std::vector<vec3>(256, vec3(0.0f)));
  scene.receivers.width = scene.receivers.height = 16;
  for (const char* backend : {"scalar", "simd"}) {
    std::set<float> values[2];
    for (const int seed : {0, 1})
      for (const vec3& e : test::shade("ray-traced", backend, {"seed=" + std::to_string(seed)}, scene))
        values[seed].insert(e.x);
    std::vector<float> both;
    std::set_intersection(values[0].begin(), values[0].end(), values[1].begin(), values[1].end(),
                          std::back_inserter(both));
    for (const auto& of_seed : values) EXPECT_EQ(of_seed.size(), 64u) << backend;
    EXPECT_LT(both.size(), 4u) << backend << ": another seed, other directions";
  }
}

TEST(RayTracedSpheres, RefusesScenesWithoutOrWithin) {
  Scene scene = test::sphere_scene({}, test::receivers_at({vec3(0.0f)}));
  const auto error = [&] {
    return test::error_of([&] { test::shade("ray-traced", "simd", {"occluder=spheres"}, scene); });
  };
  EXPECT_NE(error().find("no spheres"), std::string::npos);
  scene.spheres.spheres = {{{0, 3, 0}, 1.0f}};
  scene.receivers.on_occluder[0] = 1;
  EXPECT_NE(error().find("lie on the mesh"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
