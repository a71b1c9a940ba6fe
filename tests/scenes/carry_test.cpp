#include "scenes/carry.h"

#include <tbb/task_arena.h>

#include "scenes/scene.h"
#include "tests/support.h"

namespace penumbra {
namespace {

SphereSet spheres_in(const Mesh& mesh) {
  SphereSet set;
  for (int i = 0; i < 12; ++i)
    set.spheres.push_back({0.8f * mesh.positions[std::size_t(i) * 811 % mesh.positions.size()], 0.3f});
  set.spheres.push_back({{0, 50, 0}, 0.1f});  // far away: no vertex is its own
  return set;
}

template <class Map>
void expect_carried(Carry carry, Map map, double tolerance) {
  const Mesh rest = make_torus_knot(2, 3, 96, 12);
  const SphereSet set = spheres_in(rest);
  const SphereCarrier carrier(rest, set, carry);
  Mesh moved = rest;
  for (vec3& p : moved.positions) p = map(p);
  SphereSet out = set;
  carrier.move(moved, out);
  for (std::size_t i = 0; i < set.size(); ++i) {
    EXPECT_LT(glm::distance(out.spheres[i].centre, map(set.spheres[i].centre)), tolerance * (i == 12 ? 10.0 : 1.0))
        << i;
    EXPECT_EQ(out.spheres[i].radius, set.spheres[i].radius);
  }
}

vec3 turned(vec3 p, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  p = {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
  return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
}

TEST(SphereCarrier, RigidMotionIsExact) {
  for (const float angle : {0.0f, 0.3f, 1.5f, 3.0f})
    for (const Carry carry : {Carry::rigid, Carry::affine})
      expect_carried(
          carry, [&](vec3 p) { return turned(p, angle) + vec3(1, -2, 3); }, 2e-3);
}

TEST(SphereCarrier, AffineMotionIsExactForAffine) {
  const auto shear = [](vec3 p) { return vec3(1.3f * p.x + 0.4f * p.y, 0.8f * p.y, p.z - 0.2f * p.x); };
  expect_carried(Carry::affine, shear, 2e-3);
}

TEST(SphereCarrier, OneVertexAndFlatClustersStayFinite) {
  Mesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  triangle.triangles = {{0, 1, 2}};
  const SphereSet set{{{{0.2f, 0.5f, 0.2f}, 0.1f}, {{5, 5, 5}, 0.1f}}};
  Mesh moved = triangle;
  for (vec3& p : moved.positions) p += vec3(1, 2, 3);
  for (const Carry carry : {Carry::rigid, Carry::affine}) {
    SphereSet out = set;
    SphereCarrier(triangle, set, carry).move(moved, out);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT(glm::distance(out.spheres[i].centre, set.spheres[i].centre + vec3(1, 2, 3)), 1e-3f);
    Mesh collapsed = triangle;
    for (vec3& p : collapsed.positions) p = vec3(7.0f);
    SphereCarrier(triangle, set, carry).move(collapsed, out);
    for (const Sphere& s : out.spheres) EXPECT_TRUE(std::isfinite(s.centre.x + s.centre.y + s.centre.z));
  }
}

TEST(SphereCarrier, EqualForAnyNumberOfThreads) {
  const Mesh rest = make_torus_knot();
  Mesh moved = rest;
  for (vec3& p : moved.positions) p = turned(p, 0.5f * p.y);
  SphereSet one = spheres_in(rest), two = one;
  tbb::task_arena(1).execute([&] { SphereCarrier(rest, one, Carry::rigid).move(moved, one); });
  tbb::task_arena(2).execute([&] { SphereCarrier(rest, two, Carry::rigid).move(moved, two); });
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one.spheres[i].centre, two.spheres[i].centre);
}

TEST(SurfaceCoverage, IsAShareOfTheArea) {
  const Mesh box = make_box(vec3(0.0f), vec3(1.0f));
  EXPECT_EQ(surface_coverage(box, SphereSet{}), 0.0);
  EXPECT_EQ(surface_coverage(box, SphereSet{{{vec3(0.5f), 1.0f}}}), 1.0);
  EXPECT_NEAR(surface_coverage(box, SphereSet{{{{0.5f, 0.0f, 0.5f}, 0.4f}}}), 1.0 / 6.0, 1e-6) << "one face";
}

TEST(Animation, TwistingMeshCarriesItsSpheres) {
  Scene scene;
  scene.mesh = make_torus_knot();
  scene.spheres = spheres_in(scene.mesh);
  scene.spheres.spheres.pop_back();
  scene.receiver_spec.kind = PlaneGrid{};
  scene.light = test::constant_environment();
  scene.motion = {Motion::Kind::twist, 1.0f, 4.0f, 4};
  Animation animation(scene);
  const Frame rest = animation.frame(0);
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    EXPECT_LT(glm::distance(rest.spheres.spheres[i].centre, scene.spheres.spheres[i].centre), 1e-5f);
  const Frame twisted = animation.frame(1);
  EXPECT_TRUE(twisted.changed.spheres && twisted.changed.mesh);
  const Bounds box = bounds(scene.mesh);
  double farthest = 0.0;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const vec3 at = scene.spheres.spheres[i].centre, now = twisted.spheres.spheres[i].centre;
    const float angle = (at.y - box.low.y) / box.extent().y, c = std::cos(angle), s = std::sin(angle);
    EXPECT_LT(glm::distance(now, {c * at.x + s * at.z, at.y, c * at.z - s * at.x}), 0.1f)
        << "near to where a point goes";
    farthest = std::max(farthest, double(glm::distance(now, at)));
  }
  EXPECT_GT(farthest, 0.2);
}

}  // namespace
}  // namespace penumbra
