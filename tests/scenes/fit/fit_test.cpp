#include "scenes/fit/fit.h"

#include <tbb/task_arena.h>

#include "scenes/fit/baselines.h"
#include "scenes/fit/cover.h"
#include "scenes/fit/solid.h"
#include "scenes/ray_scene.h"
#include "tests/support.h"

namespace penumbra {
namespace {

constexpr Objective all_objectives[] = {Objective::cover, Objective::shadow, Objective::k_means, Objective::grid};

const Mesh& small_knot() {
  static const Mesh mesh = make_torus_knot(2, 3, 96, 12);
  return mesh;
}

Mesh scaled(Mesh mesh, float scale, vec3 offset = vec3(0.0f)) {
  for (vec3& p : mesh.positions) p = scale * p + offset;
  return mesh;
}

bool holds(const SphereSet& set, vec3 p) {
  return std::any_of(set.spheres.begin(), set.spheres.end(),
                     [&](const Sphere& s) { return glm::distance(dvec3(p), dvec3(s.centre)) <= s.radius; });
}

/// Every vertex, points on every triangle, and points inside.
void expect_covered(const Mesh& mesh, const SphereSet& set) {
  for (const vec3& p : mesh.positions) ASSERT_TRUE(holds(set, p));
  for (const uvec3& t : mesh.triangles)
    for (const vec3 w : {vec3(1, 1, 1) / 3.0f, vec3(0.7f, 0.2f, 0.1f), vec3(0.5f, 0.5f, 0.0f)})
      ASSERT_TRUE(holds(set, w.x * mesh.positions[t.x] + w.y * mesh.positions[t.y] + w.z * mesh.positions[t.z]));
  const SolidRows rows(mesh, 3e5);
  for (const vec3& p : interior_points(rows, rows.step())) ASSERT_TRUE(holds(set, p));
}

TEST(Fit, ABallIsOneSphere) {
  for (const Objective objective : all_objectives) {
    const SphereSet set = fit_spheres(make_sphere({1, 2, 3}, 0.5f, 64), {1, objective});
    ASSERT_EQ(set.size(), 1u) << to_string(objective);
    EXPECT_LT(glm::length(set.spheres[0].centre - vec3(1, 2, 3)), 0.02f) << to_string(objective);
    if (objective != Objective::grid) EXPECT_NEAR(set.spheres[0].radius, 0.5f, 0.02f) << to_string(objective);
  }
}

TEST(Fit, CoverHoldsEverything) {
  for (const Mesh& mesh : {small_knot(), make_box(vec3(-1, -0.2f, -0.5f), vec3(1, 0.2f, 0.5f))})
    for (const Assignment assignment : {Assignment::nearest, Assignment::flood}) {
      const SphereSet set = fit_spheres(mesh, {12, Objective::cover, 1, assignment});
      EXPECT_LE(set.size(), 12u);
      expect_covered(mesh, set);
      EXPECT_LT(assess_fit(mesh, set).uncovered, 1e-9);
    }
}

TEST(Fit, MakeCoveringGrowsSmallBalls) {
  const Mesh solid = make_solid(small_knot(), "knot");
  SphereSet set = k_means_balls(solid.positions, 10);
  for (Sphere& s : set.spheres) s.radius *= 0.8f;
  const SphereSet before = set;
  EXPECT_FALSE(loose_points(solid, set).empty());
  make_covering(solid, set);
  expect_covered(solid, set);
  for (std::size_t i = 0; i < set.size(); ++i) EXPECT_GE(set.spheres[i].radius, before.spheres[i].radius);
}

TEST(Fit, EqualForAnyNumberOfThreadsAndForASeed) {
  for (const Objective objective : all_objectives) {
    SphereSet one, two;
    tbb::task_arena(1).execute([&] { one = fit_spheres(small_knot(), {8, objective, 5}); });
    tbb::task_arena(2).execute([&] { two = fit_spheres(small_knot(), {8, objective, 5}); });
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one.spheres[i].centre, two.spheres[i].centre) << to_string(objective);
      EXPECT_EQ(one.spheres[i].radius, two.spheres[i].radius) << to_string(objective);
    }
  }
  const SphereSet a = fit_spheres(small_knot(), {8, Objective::cover, 1}),
                  b = fit_spheres(small_knot(), {8, Objective::cover, 2});
  EXPECT_NE(a.spheres[0].centre, b.spheres[0].centre) << "the seed is used";
}

TEST(Fit, OutsideVolumeBeatsTheBaselinesAndFalls) {
  double before = std::numeric_limits<double>::max();
  for (const int spheres : {4, 8, 16, 32}) {
    const auto outside = [&](Objective objective) {
      SphereSet set = fit_spheres(small_knot(), {spheres, objective});
      make_covering(small_knot(), set);  // what holds less must not look better
      return assess_fit(small_knot(), set).outside;
    };
    const double cover = outside(Objective::cover);
    EXPECT_LT(cover, 0.95 * outside(Objective::k_means)) << spheres;
    EXPECT_LT(cover, 0.7 * outside(Objective::grid)) << spheres;
    EXPECT_LT(cover, before) << spheres;
    before = cover;
  }
}

TEST(Fit, ShadowsHaveTheRightArea) {
  const Mesh& mesh = small_knot();
  const auto area = [&](const RayScene& rays, vec3 direction) {
    vec3 right, up;
    orthonormal_frame(direction, right, up);
    int hits = 0;
    for (int i = 0; i < 160 * 160; ++i) {
      const float x = (float(i % 160) + 0.5f) / 40.0f - 2.0f, y = (float(i / 160) + 0.5f) / 40.0f - 2.0f;
      hits += rays.occluded(x * right + y * up - 10.0f * direction, direction, 20.0f);
    }
    return double(hits);
  };
  const RayScene solid(mesh);
  RayScene shadow, cover;
  shadow.build(fit_spheres(mesh, {24, Objective::shadow}));
  cover.build(fit_spheres(mesh, {24, Objective::cover}));
  for (const vec3 direction :
       {vec3(0, 1, 0), vec3(1, 0, 0), glm::normalize(vec3(1, 2, 3)), glm::normalize(vec3(-3, 1, 0.5f))}) {
    const double truth = area(solid, direction);
    EXPECT_NEAR(area(shadow, direction) / truth, 1.0, 0.03);
    EXPECT_GT(area(cover, direction) / truth, 1.05) << "what covers must stick out";
  }
}

TEST(Fit, MillimetresAndKilometres) {
  const auto share = [](const Mesh& mesh) {
    const FitQuality q = assess_fit(mesh, fit_spheres(mesh, {12, Objective::cover}));
    return q.outside / q.volume;
  };
  for (const Mesh& mesh : {scaled(small_knot(), 1e-3f), scaled(small_knot(), 1e3f, {2e6f, -1e6f, 5e5f})}) {
    const SphereSet set = fit_spheres(mesh, {12, Objective::cover});
    for (const vec3& p : mesh.positions) ASSERT_TRUE(holds(set, p)) << "rounding far from the origin opens no gap";
  }
  const double metres = share(small_knot());
  EXPECT_NEAR(share(scaled(small_knot(), 1e-3f)), metres, 0.15 * metres);
  EXPECT_NEAR(share(scaled(small_knot(), 1e3f, {2e3f, -1e3f, 5e2f})), metres, 0.15 * metres);
}

TEST(Fit, ManyComponentsAreAllCovered) {
  Mesh mesh;
  for (int i = 0; i < 9; ++i) append(mesh, make_sphere({3.0f * float(i % 3), 0, 3.0f * float(i / 3)}, 0.5f, 16));
  for (const int spheres : {4, 9}) {
    const SphereSet set = fit_spheres(mesh, {spheres, Objective::cover});
    expect_covered(mesh, set);
    if (spheres == 9) {
      const FitQuality q = assess_fit(mesh, set);
      EXPECT_LT(q.outside, 0.15 * q.volume) << "one each";
    }
  }
}

TEST(Fit, FlatAndThinSolids) {
  Mesh sheet;  // two sides of one square: closed, but nothing inside
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}};
  const SphereSet set = fit_spheres(sheet, {9, Objective::cover});
  EXPECT_GT(set.size(), 1u);
  for (const vec3& p : sheet.positions) EXPECT_TRUE(holds(set, p));
  EXPECT_FALSE(fit_spheres(sheet, {9, Objective::shadow}).empty());
  EXPECT_NE(test::error_of([&] { fit_spheres(sheet, {9, Objective::k_means}); }).find("lie inside"), std::string::npos);
  const Mesh rod = make_box(vec3(0.0f), vec3(1.0f, 0.004f, 0.004f));
  expect_covered(rod, fit_spheres(rod, {16, Objective::cover}));
}

TEST(Fit, RefusesNonsense) {
  const Mesh box = make_box(vec3(0.0f), vec3(1.0f));
  EXPECT_NE(test::error_of([&] { fit_spheres(box, {0}, "box"); }).find("box: 0 spheres"), std::string::npos);
  EXPECT_NE(test::error_of([&] { fit_spheres(box, {5000}, "box"); }).find("4096"), std::string::npos);
  EXPECT_NE(test::error_of([] { fit_spheres(Mesh{}, {4}); }).find("no triangles"), std::string::npos);
  EXPECT_NE(test::error_of([] { fit_spheres(make_bowl(1.0f), {4}); }).find("not closed"), std::string::npos);
  EXPECT_NE(test::error_of([] { parse_objective("best"); }).find("shadow"), std::string::npos);
}

TEST(Fit, CacheKeepsAndMendsFits) {
  const test::TemporaryFolder folder;
  setenv("PENUMBRA_CACHE", (folder.path() + "/cache").c_str(), 1);
  const FitRequest request{6, Objective::cover};
  int computed = 0;
  const auto fit = [&] {
    return cached_fit(small_knot(), request, "knot", [&](const std::string&, double) { ++computed; });
  };
  const SphereSet first = fit();
  EXPECT_GT(computed, 0);
  computed = 0;
  EXPECT_EQ(fit().spheres[3].centre, first.spheres[3].centre);
  EXPECT_EQ(computed, 0) << "from the cache";
  for (const auto& file : std::filesystem::directory_iterator(folder.path() + "/cache"))
    std::ofstream(file.path()) << "{\"spheres\": [[1,";
  EXPECT_EQ(fit().spheres[3].centre, first.spheres[3].centre);
  EXPECT_GT(computed, 0) << "a damaged file is made anew";
  unsetenv("PENUMBRA_CACHE");
}

}  // namespace
}  // namespace penumbra
