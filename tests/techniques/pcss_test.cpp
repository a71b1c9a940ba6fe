// The shadow-map family on scenes whose answer is known, and on scenes that ask for trouble.
#include "harness/catalogue/catalogue.h"
#include "scenes/ray_scene.h"
#include "techniques/bases/area_irradiance.h"
#include "tests/techniques/lamp_scenes.h"

namespace penumbra {
namespace {

using namespace test;  // NOLINT: scenes under a lamp

const char* const family[] = {"shadow-map",   "pcss",           "hqepcss",          "fast-pcss",
                              "pcss-rotated", "moment-shadows", "shadow-map-traced"};

TEST(Pcss, HalfPlaneGivesTheExactRamp) {
  expect_ramp("pcss", {}, 0.02, lamp, 1.0);
  expect_ramp("hqepcss", {}, 0.02, lamp, 1.0);
  expect_ramp("hqepcss", {"snap_size=overlap"}, 0.02, lamp, 1.0);
  expect_ramp("moment-shadows", {}, 0.02, lamp, 1.0);
  expect_ramp("pcss-rotated", {"pattern=lattice", "search_samples=64", "filter_samples=256"}, 0.05, lamp, 1.0);
  expect_ramp("fast-pcss", {"snap_place=centre", "snap_size=up", "search_area=1", "filter_area=1", "blur=0"}, 0.25,
              lamp, 1.0);
}

TEST(Pcss, LampsThatAreNotSquareAreSquaresOfTheMap) {
  const AreaLight wide = make_rectangle({0, 4, 0}, {0.4f, 0, 0}, {0, 0, 1.6f}, vec3(10.0f));
  expect_ramp("pcss", {}, 0.03, wide, 0.4);
  expect_ramp("moment-shadows", {}, 0.03, wide, 0.4);
  const AreaLight skew = make_rectangle({0, 4, 0}, {0.5f, 0, 0}, {0.2f, 0, 1}, vec3(10.0f));
  const Scene scene =
      lamp_scene(plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 1.0f), test::receivers_at(row_of_points(-.3f, .3f, 31)), skew);
  const auto found = visibility("pcss", "simd", {}, scene),
             truth = visibility("ray-traced", "simd", {"rays=4096"}, scene);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], truth[i], 0.03) << i;
}

TEST(Pcss, AFarLampLooksTheSameThroughParallelRays) {
  const AreaLight far = make_rectangle({0, 101, 0}, {20, 0, 0}, {0, 0, 20}, vec3(10.0f));
  const Scene scene =
      lamp_scene(plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 1.0f), test::receivers_at(row_of_points(-0.3f, 0.3f, 31)), far);
  for (const char* name : {"pcss", "hqepcss", "moment-shadows"}) {
    const auto perspective = visibility(name, "simd", {"light_view=perspective"}, scene);
    const auto orthographic = visibility(name, "simd", {"light_view=orthographic"}, scene);
    for (std::size_t i = 0; i < perspective.size(); ++i) EXPECT_NEAR(perspective[i], orthographic[i], 0.06) << name;
    EXPECT_NEAR(orthographic[15], 0.5, 0.06) << name;
  }
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance, const char* what) {
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << what << " " << i;
}

TEST(Pcss, APointCastsAHardShadowOfOneTexel) {
  const Scene scene = lamp_scene(make_sphere({0, 1, 0}, 0.5f, 48), test::receivers_at(row_of_points(-1.5f, 1.5f, 300)));
  const auto hard = visibility("shadow-map", "scalar", {"light_scale=0"}, scene);
  int blocked = 0;
  for (const double v : hard) {
    EXPECT_TRUE(v < 1e-6 || std::abs(v - 1.0) < 1e-5);
    blocked += v < 0.5;
  }
  EXPECT_NEAR(blocked, 2 * 100 * 0.5 * 4 / std::sqrt(8.75), 3.0) << "tangent cone of the sphere on the plane";
  for (const char* backend : backends) {
    for (const char* name : {"pcss", "hqepcss", "pcss-rotated"})
      expect_near(visibility(name, backend, {"light_scale=0"}, scene), hard, 1e-5, name);
    expect_near(visibility("moment-shadows", backend, {"light_scale=0"}, scene), hard, 1e-3, "moment-shadows");
  }
}

TEST(Pcss, NoBlockerNoShadow) {
  const Receivers receivers = test::receivers_at(row_of_points(-2.0f, 2.0f, 40));
  const Mesh aside = make_box({50, 0, 50}, {51, 1, 51}), above = make_box({-1, 6, -1}, {1, 7, 1});
  for (const Mesh& mesh : {Mesh{}, aside, above})
    for (const char* name : family)
      for (const char* backend : backends)
        for (const double v : visibility(name, backend, {"map=64"}, lamp_scene(mesh, receivers)))
          EXPECT_NEAR(v, 1.0, 1e-5) << name << " " << backend;
}

TEST(Pcss, ALitSurfaceDoesNotShadowItself) {
  for (const float tilt : {0.0f, 0.5f}) {
    Mesh mesh = plate({-1, -1}, {1, 1}, 0.0f);
    for (vec3& p : mesh.positions) p.y = 1.0f + tilt * p.x;
    std::vector<vec3> points = row_of_points(-0.8f, 0.8f, 50);
    for (vec3& p : points) p.y = 1.0f + tilt * p.x;
    Receivers receivers = test::receivers_at(points, {-tilt, 1, 0});
    receivers.on_occluder.assign(points.size(), 1);
    for (const char* name : family)
      for (const char* backend : backends)
        for (const double v : visibility(name, backend, {"bias=2", "light_scale=0.1"}, lamp_scene(mesh, receivers)))
          EXPECT_GT(v, 0.97) << name << " " << backend << " tilted " << tilt;
  }
}

/// A slope under a lamp of 2 x 2, with receivers about its middle, and perhaps a plate over it.
Scene slope_scene(const Mesh& over = {}) {
  Mesh mesh = plate({-1, -1}, {1, 1}, 1.0f);
  for (vec3& p : mesh.positions) p.y += 0.5f * p.x;
  for (const uvec3& t : over.triangles) mesh.triangles.push_back(t + 4u);
  mesh.positions.insert(mesh.positions.end(), over.positions.begin(), over.positions.end());
  std::vector<vec3> points = row_of_points(-0.15f, 0.15f, 30);
  for (vec3& p : points) p.y = 1.0f + 0.5f * p.x;
  Receivers receivers = test::receivers_at(points, {-0.5f, 1, 0});
  receivers.on_occluder.assign(points.size(), 1);
  place_ray_origins(receivers, receivers.normal, mesh, RayScene(mesh));
  return lamp_scene(mesh, receivers, make_rectangle({0, 4, 0}, {2, 0, 0}, {0, 0, 2}, vec3(10.0f)));
}

TEST(Pcss, ASlopeUnderAWideRegionDoesNotShadowItself) {
  for (const char* name : {"pcss", "hqepcss", "fast-pcss", "pcss-rotated", "moment-shadows"})
    for (const char* backend : backends) {
      const auto least = [&](const char* region_bias) {
        std::vector<std::string> parameters = {region_bias, "bias=0.5"};
        if (std::string(name) == "hqepcss") parameters.emplace_back("refine=off");  // else its region is not wide
        const std::vector<double> found = visibility(name, backend, parameters, slope_scene());
        return *std::min_element(found.begin(), found.end());
      };
      EXPECT_LT(least("region_bias=0"), 0.85) << name << " " << backend;
      EXPECT_GT(least("region_bias=1"), 0.93) << name << " " << backend;  // snapped regions and discs reach further
    }
}

TEST(Pcss, ABlockerCloseOverASlopeIsFound) {
  for (const char* name : {"pcss", "hqepcss", "fast-pcss", "pcss-rotated", "moment-shadows"})
    for (const char* backend : backends)
      for (const double v :
           visibility(name, backend, {"region_bias=1"}, slope_scene(plate({-0.3f, -0.3f}, {0.3f, 0.3f}, 1.2f))))
        EXPECT_LT(v, 0.05) << name << " " << backend;
}

/// The slope itself is no blocker: its depth would make the mean too large, and the penumbra narrow.
TEST(Pcss, APenumbraOnASlopeIsAsWideAsItsBlockerMakesIt) {
  const Scene scene = slope_scene(plate({-0.8f, -0.8f}, {0.0f, 0.8f}, 1.4f));
  const auto truth = visibility("ray-traced", "simd", {"rays=1024"}, scene);
  const auto error = [&](const char* backend, const char* region_bias) {
    const auto found = visibility("pcss", backend, {region_bias}, scene);
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) sum += std::pow(found[i] - truth[i], 2);
    return std::sqrt(sum / double(found.size()));
  };
  for (const char* backend : {"scalar", "simd", "cuda"}) {
    EXPECT_LT(error(backend, "region_bias=1"), 0.09) << backend;
    EXPECT_GT(error(backend, "region_bias=0"), 0.2) << backend;
  }
}

TEST(Pcss, BackendsAgreeOnSlopes) {
  const Scene scene = slope_scene(plate({-0.8f, -0.8f}, {0.0f, 0.8f}, 1.4f));
  for (const char* name : {"pcss", "hqepcss", "fast-pcss", "pcss-rotated", "moment-shadows"})
    for (const char* backend : {"simd", "cuda"})
      if (backend == std::string("simd") || std::string(name).ends_with("pcss"))
        expect_near(visibility(name, backend, {"region_bias=0.7", "map=256"}, scene),
                    visibility(name, "scalar", {"region_bias=0.7", "map=256"}, scene), 1e-3, name);
}

TEST(Pcss, ABlockerAtTheLampCoversAllOfIt) {
  const Scene scene =
      lamp_scene(plate({-1.0f, -1.0f}, {1.0f, 1.0f}, 3.99f), test::receivers_at(row_of_points(-1, 1, 9)));
  for (const char* name : {"pcss", "hqepcss", "pcss-rotated", "moment-shadows", "fast-pcss"})
    for (const char* backend : backends) {
      const auto found = visibility(name, backend, {"map=256"}, scene);
      for (const double v : found) EXPECT_TRUE(v >= -1e-6 && v <= 1.0 + 1e-5) << name << " " << backend << " " << v;
      if (std::string(name) == "pcss") EXPECT_NEAR(found[4], 0.0, 0.02) << backend;
    }
}

TEST(Pcss, TwoDepthsBecomeOneMean) {
  // Where both plates cover a part of the lamp their shares do not add up: a known bias, of either sign.
  Mesh mesh = plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 0.5f);
  const Mesh upper = plate({0.1f, -1.5f}, {1.5f, 1.5f}, 2.0f);
  for (const uvec3& t : upper.triangles) mesh.triangles.push_back(t + 4u);
  mesh.positions.insert(mesh.positions.end(), upper.positions.begin(), upper.positions.end());
  const Scene scene = lamp_scene(mesh, test::receivers_at(row_of_points(-0.2f, 0.4f, 31)));
  const auto found = visibility("pcss", "simd", {}, scene),
             truth = visibility("ray-traced", "simd", {"rays=4096"}, scene);
  double worst = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) worst = std::max(worst, std::abs(found[i] - truth[i]));
  EXPECT_GT(worst, 0.05);
  EXPECT_LT(worst, 0.6);
}

TEST(Pcss, RightWidthsBeatDoubledOnes) {
  const Scene scene =
      lamp_scene(make_sphere({0, 0.8f, 0}, 0.5f, 96), test::receivers_at(row_of_points(-1.5f, 1.5f, 200)));
  const auto truth = visibility("ray-traced", "simd", {"rays=4096"}, scene);
  const auto error = [&](const char* name, const std::vector<std::string>& parameters) {
    const auto found = visibility(name, "simd", parameters, scene);
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) sum += std::pow(found[i] - truth[i], 2);
    return std::sqrt(sum / double(found.size()));
  };
  EXPECT_LT(error("pcss", {}), 0.05);
  EXPECT_LT(error("pcss", {}), 0.5 * error("pcss", {"light_scale=2"}));
  EXPECT_LT(error("pcss", {}), 0.5 * error("shadow-map", {}));
  EXPECT_LT(error("hqepcss", {}), 0.06);
  EXPECT_LT(error("moment-shadows", {}), 0.06);
}

TEST(Pcss, SignedErrorTellsLeaksFromDarkening) {
  Receivers receivers = test::receivers_at({});
  const Mesh ball = make_sphere({0, 1, 0}, 0.5f, 96);
  for (std::size_t i = 0; i < ball.positions.size(); i += 7) {  // the ball's own lit side
    const vec3 n = glm::normalize(ball.positions[i] - vec3(0, 1, 0));
    if (n.y < 0.3f) continue;
    receivers.position.push_back(ball.positions[i]), receivers.normal.push_back(n);
    receivers.albedo.emplace_back(1.0f), receivers.on_occluder.push_back(1);
  }
  receivers.width = int(receivers.position.size());
  place_ray_origins(receivers, receivers.normal, ball, RayScene(ball));
  const Scene scene = lamp_scene(ball, receivers);
  const auto mean = [&](const std::vector<std::string>& parameters) {
    double sum = 0.0;
    for (const double v : visibility("pcss", "simd", parameters, scene)) sum += v;
    return sum / double(receivers.width);
  };
  const double truth = [&] {
    double sum = 0.0;
    for (const double v : visibility("ray-traced", "simd", {"rays=1024"}, scene)) sum += v;
    return sum / double(receivers.width);
  }();
  EXPECT_LT(mean({"bias=0", "region_bias=0"}), truth - 0.02) << "without a bias the surface darkens itself";
  EXPECT_GT(mean({"bias=10", "region_bias=0"}), mean({"bias=0", "region_bias=0"}) + 0.02);
  EXPECT_GT(mean({"bias=0"}), mean({"bias=0", "region_bias=0"}) + 0.02) << "and so does one that grows";
}

// --- scenes that ask for trouble -------------------------------------------------------------------------------------

struct Trouble {
  const char* name;
  Scene scene;
};

std::vector<Trouble> troubles() {
  std::vector<vec3> points = row_of_points(-2.0f, 2.0f, 37);
  points.emplace_back(0, 5, 0);     // behind the lamp
  points.emplace_back(1e8f, 0, 0);  // far off the map
  points.emplace_back(NAN, 0, 0);
  points.emplace_back(0, 4, 0);  // in the lamp
  const Receivers receivers = test::receivers_at(points);
  const Mesh ball = make_sphere({0, 1, 0}, 0.5f, 24);
  const auto at = [&](vec3 centre, vec3 u, vec3 v) {
    return lamp_scene(ball, receivers, make_rectangle(centre, u, v, vec3(3.0f)));
  };
  return {{"lamp inside the occluder", at({0, 1, 0}, {0.2f, 0, 0}, {0, 0, 0.2f})},
          {"lamp cuts the occluder", at({0.3f, 1.2f, 0}, {2, 0, 0}, {0, 0, 2})},
          {"lamp faces away", at({0, 4, 0}, {0, 0, 1}, {1, 0, 0})},
          {"lamp below the receivers", at({0, -1, 0}, {1, 0, 0}, {0, 0, 1})},
          {"no area", at({0, 4, 0}, {0, 0, 0}, {0, 0, 1})},
          {"disc of radius 0", lamp_scene(ball, receivers, make_disc({0, 4, 0}, {0, -1, 0}, 0.0f, vec3(3.0f)))},
          {"sideways", at({3, 0.5f, 0}, {0, 1, 0}, {0, 0, 1})},
          {"huge", at({0, 4, 0}, {1000, 0, 0}, {0, 0, 1000})},
          {"tiny", at({0, 4, 0}, {1e-5f, 0, 0}, {0, 0, 1e-5f})},
          {"parallel edges", at({0, 4, 0}, {0.1f, 0.2f, 0.3f}, {0.3f, 0.6f, 0.9f})},
          {"minute", at({0, 4, 0}, {1e-25f, 0, 0}, {0, 0, 1e-25f})},
          {"of a millionth", at({0, 4, 0}, {1e-13f, 0, 0}, {0, 0, 1e-10f})},
          {"a needle", at({0, 4, 0}, {1e-25f, 0, 0}, {0, 0, 1})},
          {"vast", at({0, 4, 0}, {1e12f, 0, 0}, {0, 0, 1e12f})},
          {"far", at({0, 1e5f, 0}, {1, 0, 0}, {0, 0, 1})},
          {"no mesh", lamp_scene({}, receivers)}};
}

TEST(Pcss, TroubleGivesDefinedResults) {
  for (const Trouble& t : troubles())
    for (const char* name : family)
      for (const char* backend : backends)
        for (const char* map : {"map=1", "map=100"})
          for (const char* view : {"light_view=perspective", "light_view=orthographic"}) {
            const auto image = test::shade(name, backend, {map, view}, t.scene);
            const AreaLight& light = *area_light_of(t.scene.light);
            const LampOutline outline = make_outline(light);
            for (std::size_t i = 0; i < image.size(); ++i) {
              const float open =
                  light.radiance.x * form_factor(outline, t.scene.receivers.position[i], t.scene.receivers.normal[i]);
              ASSERT_TRUE(image[i].x >= 0.0f && image[i].x <= open * 1.001f + 1e-6f)
                  << t.name << ", " << name << " " << backend << " " << map << " " << view << ", receiver " << i << ": "
                  << image[i].x << " of " << open;
            }
          }
}

TEST(Pcss, VerticesThatTheMapCannotHoldAreCounted) {
  const auto count = [](const Scene& scene) {
    static const Registry registry = make_registry();
    const auto technique = make_technique(registry.find("pcss", "simd"), parse_parameters({"map=64"}));
    technique->prepare(scene);
    return technique->counters().at("vertices_off_map");
  };
  EXPECT_EQ(count(lamp_scene(make_sphere({0, 1, 0}, 0.5f, 24), test::receivers_at(row_of_points(-1, 1, 3)))), 0u);
  EXPECT_GT(count(troubles()[1].scene), 0u);
}

TEST(Pcss, StagesAreNamedInOrder) {
  static const Registry registry = make_registry();
  const auto technique = make_technique(registry.find("fast-pcss", "simd"), parse_parameters({"map=64"}));
  const Scene scene = lamp_scene(make_sphere({0, 1, 0}, 0.5f, 24), test::receivers_at(row_of_points(-1, 1, 300)));
  test::shade(*technique, scene);
  std::vector<std::string> names;
  for (const Stage& stage : technique->stages()) {
    names.push_back(stage.name);
    EXPECT_GE(stage.ms, 0.0);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"lighting", "map", "levels", "project", "regions", "blockers", "filter",
                                             "blur", "compose"}));
  Animation animation(scene);
  technique->update(animation.frame(0));
  EXPECT_EQ(technique->stages()[1].ms, 0.0) << "nothing changed, no map was made";
}

TEST(Pcss, AFloorOfTheMeshsOwnDoesNotShadowThePlaneOnIt) {
  const Mesh floor = make_box({-3, -0.5f, -3}, {3, 0, 3});
  const AreaLight slanting = make_rectangle({2, 3, 1}, {0.3f, -0.2f, 0}, {0, 0, 0.3f}, vec3(10.0f));
  const Scene scene = lamp_scene(floor, make_receivers({PlaneGrid{1.0f, 24, 0.0f}, vec3(1.0f)}, floor), slanting);
  for (const char* name : family)
    for (const char* backend : backends) {
      const std::vector<double> found = visibility(name, backend, {"map=256"}, scene);
      EXPECT_GT(*std::min_element(found.begin(), found.end()), 0.95) << name << " " << backend;
      EXPECT_GT(test::shade(name, backend, {"map=256"}, scene)[0].x, 0.001f) << "and it is lit";
    }
}

}  // namespace
}  // namespace penumbra
