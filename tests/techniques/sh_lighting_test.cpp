// Diffuse transfer against closed forms.
#include "harness/measure/parity.h"
#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

class ShLighting : public testing::TestWithParam<const char*> {
 protected:
  static std::vector<vec3> shaded(const Scene& scene, const std::vector<std::string>& parameters) {
    return test::shade("sh-lighting", GetParam(), parameters, scene);
  }
};

TEST_P(ShLighting, WithoutOccluderConstantLightGivesOne) {
  Scene scene = test::sphere_scene({}, test::receivers_at({vec3(0.0f), vec3(1, 2, 3)}, {0.3f, -1, 0.2f}));
  for (const char* transfer : {"transfer=unshadowed", "transfer=shadowed", "transfer=interreflected"})
    for (const char* order : {"order=2", "order=6"})
      for (const vec3& e : shaded(scene, {transfer, order, "directions=100"})) EXPECT_NEAR(e.x, 1.0f, 1e-6f);
  EXPECT_NEAR(shaded(scene, {"estimator=plain", "transfer=unshadowed"})[0].x, 1.0f, 2e-3f);
}

TEST_P(ShLighting, CapsComeNearTheirClosedForms) {
  for (const double theta : {0.2, 0.7, 1.2})
    for (const char* estimator : {"estimator=complement", "estimator=plain"}) {
      const Scene scene = test::sphere_scene({test::cap_sphere({0, 1, 0}, theta)}, test::receivers_at({vec3(0.0f)}));
      EXPECT_NEAR(double(shaded(scene, {estimator})[0].x), 1 - std::pow(std::sin(theta), 2), 4e-3) << theta;
    }
}

/// Every point of a hemispherical bowl sees the sky with e = 1/2, and the bowl with the rest. Hard case 37.
TEST_P(ShLighting, HemisphericalBowl) {
  Scene scene = test::sphere_scene({}, {});
  scene.mesh = make_bowl(1.0f);
  std::vector<vec3> points;
  for (const vec3 w : {vec3(0, -1, 0), vec3(0.6f, -0.8f, 0), vec3(0.5f, -0.5f, -0.70710678f)})
    points.push_back(0.995f * w);
  scene.receivers = test::receivers_at(points);
  const double albedo[3] = {0.8, 0.5, 0.0};
  scene.receiver_spec.albedo = vec3(0.8f, 0.5f, 0.0f);
  for (std::size_t i = 0; i < points.size(); ++i) scene.receivers.normal[i] = -glm::normalize(points[i]);
  for (const int bounces : {0, 1, 3}) {
    const auto image =
        shaded(scene, {"transfer=interreflected", "directions=2500", "bounces=" + std::to_string(bounces)});
    for (const vec3& e : image)
      for (int c = 0; c < 3; ++c) {
        double expected = 0.0;
        for (int k = 0; k <= bounces; ++k) expected += 0.5 * std::pow(albedo[c] / 2, k);
        EXPECT_NEAR(double(e[c]), expected, 0.012) << bounces;
      }
  }
  for (const vec3& e : shaded(scene, {"directions=2500"})) EXPECT_NEAR(e.x, 0.5f, 0.01f) << "direct";
}

TEST_P(ShLighting, TheBackOfAMeshIsBlack) {
  Scene scene = test::sphere_scene({}, test::receivers_at({vec3(0, -2, 0)}));
  scene.mesh = make_bowl(1.0f);  // seen from below: its outside
  const std::vector<std::string> few = {"directions=400"};
  const auto direct = shaded(scene, few), bounced = shaded(scene, {"directions=400", "transfer=interreflected"});
  EXPECT_NEAR(bounced[0].x, direct[0].x, 1e-6f);
  EXPECT_LT(direct[0].x, 0.9f) << "it is in the way";
}

/// A triangle overhead, lit from below, whose normals leave light to its first vertex alone: a point just under it sees
/// the first barycentric coordinate.
TEST_P(ShLighting, BouncesAreInterpolatedBetweenTheirVertices) {
  Scene scene = test::sphere_scene({}, {});
  Environment below = test::constant_environment();
  for (int i = 0; i < int(below.radiance.size()); ++i)
    if (below.direction(i, 0.5f, 0.5f).y > 0.0f) below.radiance[std::size_t(i)] = vec3(0.0f);
  scene.light = below;
  const vec3 corner[3] = {{-20, 1, -10}, {20, 1, -10}, {0, 1, 20}};
  scene.mesh.positions.assign(corner, corner + 3);
  scene.mesh.triangles = {{0, 1, 2}};
  scene.mesh.normals = {{0, -1, 0}, {0, 1, 0}, {0, 1, 0}};
  const dvec3 places[] = {{0.6, 0.3, 0.1}, {0.2, 0.2, 0.6}, {0.25, 0.6, 0.15}};
  std::vector<vec3> points;
  for (const dvec3& w : places)
    points.push_back(float(w.x) * corner[0] + float(w.y) * corner[1] + float(w.z) * corner[2] - vec3(0, 0.05f, 0));
  scene.receivers = test::receivers_at(points);
  const auto image = shaded(scene, {"transfer=interreflected", "directions=2500", "order=6"});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(double(image[i].x), places[i].x, 0.06) << i;
}

TEST_P(ShLighting, TurningSceneAndLightTogetherChangesNothing) {
  Scene scene = thinned(load_scene("torus-knot-lamps"), 8);
  const auto still = shaded(scene, {"transfer=unshadowed"}), shadowed = shaded(scene, {});
  const float angle = 0.9f, c = std::cos(angle), s = std::sin(angle);
  const auto turn = [&](vec3& p) { p = {c * p.x + s * p.z, p.y, c * p.z - s * p.x}; };
  for (vec3& p : scene.mesh.positions) turn(p);
  for (vec3& p : scene.receivers.position) turn(p);
  for (vec3& p : scene.receivers.origin) turn(p);
  for (vec3& n : scene.receivers.normal) turn(n);
  std::get<Environment>(scene.light).rotation = double(angle);
  EXPECT_LT(test::difference(shaded(scene, {"transfer=unshadowed"}), still), 1e-6);
  EXPECT_LT(test::difference(shaded(scene, {}), shadowed), 2e-3) << "other rays, the same shadow";
}

TEST_P(ShLighting, ErrorFallsWithTheOrder) {
  const Scene scene = thinned(load_scene("torus-knot-softbox"), 16);
  const auto truth = test::shade("ray-traced", "simd", {"rays=4096"}, scene);
  double before = 1.0;
  for (const char* order : {"order=2", "order=4", "order=6"}) {
    const double error = test::difference(shaded(scene, {order, "directions=2500"}), truth);
    EXPECT_LT(error, before) << order;
    before = error;
  }
  EXPECT_LT(before, 0.01);
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, ShLighting, testing::Values("scalar", "simd"));

}  // namespace
}  // namespace penumbra
