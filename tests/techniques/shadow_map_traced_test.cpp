#include "techniques/shadow_map_traced/shadow_map_traced.h"

#include "tests/techniques/lamp_scenes.h"

namespace penumbra::shadow_map_traced {
namespace {

using namespace test;  // NOLINT: scenes under a lamp

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Walks over what is stored at depths 1, 2, 3, ...
bool hits(const Walking& how, std::initializer_list<float> stored) {
  Walk walk{0.5f, infinity, 0.0f, false};
  float z = 1.0f;
  for (const float depth : stored) step(how, z, depth, walk), z += 1.0f;
  return walk.hit;
}

TEST(ShadowMapTraced, CrossingASurfaceIsAHit) {
  const Walking how;
  EXPECT_FALSE(hits(how, {infinity, infinity, infinity}));
  EXPECT_FALSE(hits(how, {5, 5, 5, 5}));
  EXPECT_TRUE(hits(how, {2.5f, 2.5f, 2.5f}));
  EXPECT_TRUE(hits(how, {infinity, 1.5f})) << "it was in front of what it is behind now";
  EXPECT_FALSE(hits(how, {infinity, infinity, 1.5f})) << "it came behind that from the side";
}

TEST(ShadowMapTraced, ASurfaceThatIsHiddenGoesOnWithItsSlope) {
  const Walking how;
  // A floor that rises by 0.5 a step, from 4 to 3.5, then an edge of depth 1 hides it: at depth 3 the floor would be at
  // 3, at depth 4 at 2.5.
  EXPECT_FALSE(hits(how, {4.0f, 3.5f, 1.0f}));
  EXPECT_TRUE(hits(how, {4.0f, 3.5f, 1.0f, 1.0f}));
  // A floor that sinks as fast as the ray does is never met.
  EXPECT_FALSE(hits(how, {4.0f, 5.0f, 1.0f, 1.0f, 1.0f, 1.0f}));
  // With the slope held to nothing it stays at 5.
  EXPECT_TRUE(hits({8, 0.0f, 0.0f, 1.0f}, {4.0f, 5.0f, 1.0f, 1.0f, 1.0f, 1.0f}));
}

TEST(ShadowMapTraced, ThicknessStopsWhatComesFromTheSide) {
  EXPECT_FALSE(hits({8, 1.0f, 0.4f, 1.0f}, {infinity, infinity, 1.5f}));
  EXPECT_TRUE(hits({8, 1.0f, 0.6f, 1.0f}, {infinity, infinity, 1.5f}));
}

TEST(ShadowMapTraced, StepsAreEvenOnTheMap) {
  LightView view;
  for (const bool perspective : {true, false}) {
    view.perspective = perspective, view.resolution = 1 << 20;
    const float whole = view.region(1.0f, 4.0f);
    for (const float f : {0.0f, 0.25f, 0.5f, 1.0f})
      EXPECT_NEAR(view.region(depth_at(view, 1.0f, 4.0f, f), 4.0f), f * whole, 1e-5) << perspective << " " << f;
  }
}

TEST(ShadowMapTraced, HalfPlaneGivesTheExactRamp) {
  expect_ramp("shadow-map-traced", {"rays=256", "steps=64"}, 0.05, lamp, 1.0);
}

TEST(ShadowMapTraced, TwoBlockersAddUp) {
  // What one mean blocker depth cannot tell apart (Pcss.TwoDepthsBecomeOneMean).
  Mesh mesh = plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 0.5f);
  const Mesh upper = plate({0.1f, -1.5f}, {1.5f, 1.5f}, 2.0f);
  for (const uvec3& t : upper.triangles) mesh.triangles.push_back(t + 4u);
  mesh.positions.insert(mesh.positions.end(), upper.positions.begin(), upper.positions.end());
  const Scene scene = lamp_scene(mesh, test::receivers_at(row_of_points(-0.2f, 0.4f, 31)));
  const auto truth = visibility("ray-traced", "simd", {"rays=4096"}, scene);
  for (const char* backend : backends) {
    const auto found = visibility("shadow-map-traced", backend, {"rays=256", "steps=64"}, scene);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], truth[i], 0.06) << backend << " " << i;
  }
}

}  // namespace
}  // namespace penumbra::shadow_map_traced
