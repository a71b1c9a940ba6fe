// Volumes of balls against solids: closed forms, and counting voxels as the oracle.
#include "scenes/fit/difference.h"
#include "scenes/fit/fit.h"
#include "scenes/fit/outside_volume.h"
#include "scenes/fit/solid.h"
#include "scenes/fit/solid_rows.h"
#include "scenes/ray_scene.h"
#include "tests/support.h"

namespace penumbra {
namespace {

const Mesh& cube() {
  static const Mesh mesh = make_solid(make_box(vec3(-1.0f), vec3(1.0f)), "cube");
  return mesh;
}

double ball(double radius) {
  return 4.0 / 3.0 * pi * radius * radius * radius;
}

/// h^3 times the number of voxel centres in the sphere and outside the solid, h = R / 50.
double counted(const Mesh& solid, const Sphere& s) {
  const RayScene rays(solid);
  const double h = s.radius / 50.0;
  std::size_t count = 0;
  for (int x = -50; x < 50; ++x)
    for (int y = -50; y < 50; ++y)
      for (int z = -50; z < 50; ++z) {
        const dvec3 offset = h * (dvec3(x, y, z) + 0.5);
        count += glm::length(offset) <= s.radius && !inside(rays, s.centre + vec3(offset));
      }
  return double(count) * h * h * h;
}

TEST(OutsideVolume, ClosedFormsOfTheCube) {
  EXPECT_NEAR(outside_volume(cube(), Sphere{vec3(0.0f), std::sqrt(3.0f)}), 4.0 * std::sqrt(3.0) * pi - 8.0, 1e-5);
  EXPECT_NEAR(outside_volume(cube(), Sphere{vec3(0.0f), std::sqrt(3.0f)}), 13.76559, 1e-4);
  EXPECT_NEAR(outside_volume(cube(), Sphere{vec3(0.0f), 0.9f}), 0.0, 1e-9);
  EXPECT_NEAR(outside_volume(cube(), Sphere{vec3(0.0f), 1.2f}), 6.0 * pi * 0.04 * 3.4 / 3.0, 1e-5);
  EXPECT_NEAR(outside_volume(cube(), Sphere{{1.5f, 0, 0}, 1.0f}), 3.53429, 1e-5);
}

TEST(OutsideVolume, CentresOnFacesEdgesAndCorners) {
  const float r = 0.5f;
  EXPECT_NEAR(outside_volume(cube(), Sphere{{1, 0.1f, 0.2f}, r}), ball(r) / 2, 1e-9);
  EXPECT_NEAR(outside_volume(cube(), Sphere{{1, 0.3f, 0.3f}, r}), ball(r) / 2, 1e-9) << "on the diagonal edge";
  EXPECT_NEAR(outside_volume(cube(), Sphere{{1, 1, 0.2f}, r}), ball(r) * 3 / 4, 1e-9);
  EXPECT_NEAR(outside_volume(cube(), Sphere{{1, 1, 1}, r}), ball(r) * 7 / 8, 1e-9);
}

TEST(OutsideVolume, NoRadiusFarAwayAndWithin) {  // hard case 41
  EXPECT_EQ(outside_volume(cube(), Sphere{vec3(0.5f), 0.0f}), 0.0);
  EXPECT_NEAR(outside_volume(cube(), Sphere{{50, 0, 0}, 2.0f}), ball(2.0), 1e-9);
  EXPECT_NEAR(outside_volume(cube(), Sphere{{0.2f, 0, 0}, 100.0f}), ball(100.0) - 8.0, 1e-3);
}

TEST(OutsideVolume, ZeroAreaTrianglesContributeNothing) {  // hard case 42
  Mesh mesh = cube();
  mesh.positions.insert(mesh.positions.end(), {{1, 0, 0}, {1, 0.5f, 0}, {1, 1, 0}});
  mesh.triangles.push_back({8, 9, 10});
  EXPECT_EQ(outside_volume(mesh, Sphere{{0.9f, 0.4f, 0}, 0.7f}), outside_volume(cube(), Sphere{{0.9f, 0.4f, 0}, 0.7f}));
}

TEST(OutsideVolume, AgreesWithCountedVoxels) {
  const Mesh knot = make_solid(make_torus_knot(2, 3, 96, 12), "knot");
  for (const Sphere& s : {Sphere{knot.positions[100], 0.3f}, Sphere{vec3(0.1f, 0.2f, 0.3f), 0.9f},
                          Sphere{0.7f * knot.positions[500], 0.5f}}) {
    const double exact = outside_volume(knot, s);
    EXPECT_NEAR(counted(knot, s), exact, 3e-3 * ball(s.radius));
    EXPECT_GT(exact, 0.05 * ball(s.radius));
  }
}

TEST(OutsideVolume, SumsOverSpheres) {
  const SphereSet set{{{{1.5f, 0, 0}, 1.0f}, {{1.5f, 0, 0}, 1.0f}}};
  EXPECT_NEAR(outside_volume(cube(), set), 2 * 3.53429, 2e-5) << "what two share counts twice";
}

TEST(SolidRows, VolumesComeNearToTheExactOnes) {
  const Mesh knot = make_solid(make_torus_knot(), "knot");
  const SolidRows rows(knot, 2e6);
  EXPECT_NEAR(rows.volume(), enclosed_volume(knot), 1e-3 * enclosed_volume(knot));
  for (int i = 0; i < 40; ++i) {
    const Sphere s{knot.positions[(i * 997u) % knot.positions.size()], 0.15f + 0.01f * float(i)};
    EXPECT_NEAR(rows.outside_volume(s.centre, s.radius), outside_volume(knot, s), 0.01 * ball(s.radius));
  }
}

TEST(SolidRows, InsideAgreesWithRays) {
  const Mesh knot = make_torus_knot();
  const SolidRows rows(knot, 1e6);
  const RayScene rays(knot);
  int in = 0;
  for (int z = 0; z < rows.size(2); z += 3)
    for (int y = 0; y < rows.size(1); y += 3)
      for (int x = 0; x < rows.size(0); x += 3) {
        const vec3 p = rows.cell_centre(x, y, z);
        ASSERT_EQ(rows.inside(p), inside(rays, p));
        in += rows.inside(p);
      }
  EXPECT_GT(in, 1000);
  EXPECT_FALSE(rows.inside(rows.box().high + 1.0f));
}

TEST(Difference, OfBallsAndCube) {
  const double around = ball(std::sqrt(3.0)) - 8.0, pokes = 6.0 * pi * 0.04 * 3.4 / 3.0;
  const Difference both = difference(cube(), SphereSet{{{vec3(0.0f), std::sqrt(3.0f)}, {vec3(0.0f), 1.2f}}});
  EXPECT_NEAR(both.uncovered, 0.0, 1e-6);
  EXPECT_NEAR(both.shared, pokes, 2e-3) << "outside in both";
  const Difference within = difference(cube(), SphereSet{{{vec3(0.0f), 1.0f}}});
  EXPECT_NEAR(within.uncovered, 8.0 - ball(1.0), 2e-3);
  EXPECT_EQ(within.shared, 0.0);
  EXPECT_NEAR(difference(cube(), SphereSet{}).uncovered, 8.0, 1e-4) << "faces along the axes";
  const FitQuality q = assess_fit(cube(), SphereSet{{{vec3(0.0f), std::sqrt(3.0f)}, {vec3(0.0f), 1.2f}}});
  EXPECT_NEAR(q.excess, around, 3e-3) << "of the union";
  EXPECT_NEAR(q.outside, around + pokes, 1e-5) << "summed";
}

}  // namespace
}  // namespace penumbra
