#include "scenes/ray_origins.h"

#include <random>

#include "scenes/receivers.h"
#include "tests/support.h"

namespace penumbra {
namespace {

double unit(std::mt19937& random) {
  return double(random() >> 5) * 0x1p-27;
}

dvec3 on_unit_sphere(std::mt19937& random) {
  const double y = 2.0 * unit(random) - 1.0, a = 2.0 * pi * unit(random), r = std::sqrt(1.0 - y * y);
  return {r * std::cos(a), y, r * std::sin(a)};
}

Mesh one_triangle(dvec3 a, dvec3 b, dvec3 c) {
  Mesh mesh;
  mesh.positions = {vec3(a), vec3(b), vec3(c)};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// A direction above the surface, often only a little.
vec3 rising(std::mt19937& random, dvec3 side) {
  const dvec3 w = on_unit_sphere(random), flat = w - glm::dot(w, side) * side;
  return vec3(glm::normalize(flat + side * std::pow(10.0, -4.0 * unit(random))));
}

/// Rays from points of a random triangle that meet it although they rise from it, out of `count`.
int own_hits(std::mt19937& random, double size, double away, double thinness, int count) {
  const dvec3 at = away * size * on_unit_sphere(random), along = size * on_unit_sphere(random);
  const dvec3 across = thinness * size * glm::normalize(glm::cross(along, on_unit_sphere(random)));
  const Mesh mesh = one_triangle(at, at + along, at + unit(random) * along + across);
  const RayScene rays(mesh);
  const RayOrigins origins(mesh, rays);
  const dvec3 a = mesh.positions[0], b = mesh.positions[1], c = mesh.positions[2];
  const dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  int hits = 0;
  for (int k = 0; k < count; ++k) {
    double u = unit(random), v = unit(random);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const dvec3 side = k % 2 ? normal : -normal;
    const vec3 point(a + u * (b - a) + v * (c - a));
    const vec3 origin = point + origins.contact(point).distance * vec3(side);
    hits += bool(rays.intersect(origin, rising(random, side)));
  }
  return hits;
}

TEST(RayOrigins, NoRayMeetsTheTriangleThatItLeaves) {
  std::mt19937 random(1);
  for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e6})
    for (const double away : {0.0, 1.0, 30.0, 1e3, 1e4})
      for (const double thinness : {1.0, 0.1, 0.01})
        for (int triangle = 0; triangle < 40; ++triangle)
          ASSERT_EQ(own_hits(random, size, away, thinness, 50), 0) << size << " m, " << away << " away, " << thinness;
}

TEST(RayOrigins, AGroundOfAnySizeDoesNotShadowItself) {
  std::mt19937 random(2);
  for (const float extent : {1.0f, 1e3f, 1e5f}) {
    Mesh ground = make_box({-extent, -1.0f, -extent}, {extent, 0.0f, extent});
    const Receivers r = make_receivers({PlaneGrid{1.0f, 16, 0.0f}, vec3(1.0f)}, ground);
    const RayScene rays(ground);
    for (int i = 0; i < r.size(); ++i)
      for (int k = 0; k < 50; ++k) {
        ASSERT_TRUE(r.touches[i]);
        ASSERT_FALSE(rays.occluded(r.ray_origin(i), rising(random, {0, 1, 0}), INFINITY)) << extent;
      }
  }
}

TEST(RayOrigins, WhatStandsElsewhereChangesNothing) {
  const Mesh near = make_sphere({0, 1, 0}, 1.0f, 48);
  const ReceiverSpec spec{PlaneGrid{2.0f, 24, 0.0f}, vec3(1.0f)};
  const std::vector<vec3> alone = make_receivers(spec, near).origin;
  for (const float size : {10.0f, 1e5f}) {
    Mesh both = near;
    const Mesh far = make_box(vec3(2e5f), vec3(2e5f + size));
    for (const vec3& p : far.positions) both.positions.push_back(p);
    for (const uvec3& t : far.triangles) both.triangles.push_back(t + unsigned(near.positions.size()));
    EXPECT_EQ(make_receivers(spec, both).origin, alone) << size;
  }
}

TEST(RayOrigins, SliversAndSlabsThatTouchNothingChangeNothing) {
  const Mesh near = make_box({-0.3f, 0, -0.3f}, {0.3f, 0.6f, 0.3f});
  const ReceiverSpec spec{PlaneGrid{1.0f, 24, 0.0f}, vec3(1.0f)};
  const std::vector<vec3> alone = make_receivers(spec, near).origin;
  for (const Mesh& other : {one_triangle({-500, -0.5, 0}, {500, -0.5, 0}, {0, -0.5, 0.1}),
                            one_triangle({-6e4, 20, 20}, {6e4, 20, 20}, {0, 20, 20.1}),
                            make_box({-1e4f, -0.2f, -1e4f}, {1e4f, -0.05f, 1e4f})}) {
    Mesh both = near;
    for (const vec3& p : other.positions) both.positions.push_back(p);
    for (const uvec3& t : other.triangles) both.triangles.push_back(t + unsigned(near.positions.size()));
    EXPECT_EQ(make_receivers(spec, both).origin, alone);
  }
}

TEST(RayOrigins, TheyScaleWithTheScene) {
  Mesh mesh = make_torus_knot();
  const std::vector<vec3> metres = make_receivers({MeshVertices{}, vec3(1.0f)}, mesh).origin;
  for (const float scale : {0x1p-20f, 0x1p20f}) {  // powers of two round alike
    Mesh scaled = mesh;
    for (vec3& p : scaled.positions) p *= scale;
    const std::vector<vec3> found = make_receivers({MeshVertices{}, vec3(1.0f)}, scaled).origin;
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], scale * metres[i]) << scale;
  }
}

TEST(RayOrigins, BlockersAtAHairAreSeen) {
  for (const float height : {1e-2f, 1e-4f, 1e-5f}) {  // of a roof of 2 m
    const Mesh roof = make_box({-1, height, -1}, {1, height + 0.1f, 1});
    const Receivers r = make_receivers({PlaneGrid{0.5f, 8, 0.0f}, vec3(1.0f)}, roof);
    const RayScene rays(roof);
    for (int i = 0; i < r.size(); ++i) EXPECT_TRUE(rays.occluded(r.ray_origin(i), {0, 1, 0}, INFINITY)) << height;
  }
}

TEST(RayOrigins, AtContactASolidIsTight) {
  std::mt19937 random(3);
  for (const float y : {0.0f, 0.1f, 1500.0f}) {
    const Mesh box = make_box({-1, y, -1}, {1, y + 1.0f, 1});
    const Receivers r = make_receivers({PlaneGrid{0.999f, 16, y}, vec3(1.0f)}, box);
    const RayScene rays(box);
    for (int i = 0; i < r.size(); ++i)
      for (int k = 0; k < 50; ++k)
        ASSERT_TRUE(rays.occluded(r.ray_origin(i), rising(random, {0, 1, 0}), INFINITY)) << y;
  }
}

TEST(Receivers, ShadingNormalsAreTheMeshsAndSidesGeometric) {
  Mesh mesh = make_box(vec3(-1.0f), vec3(1.0f));
  mesh.normals.assign(mesh.positions.size(), glm::normalize(vec3(1, 2, 3)));
  const Receivers r = make_receivers({Camera{{0, 5, 0.01f}, vec3(0.0f), 10.0f, 9, 9, false}, vec3(1.0f)}, mesh);
  for (int i = 0; i < r.size(); ++i) {
    EXPECT_LT(glm::distance(r.normal[i], glm::normalize(vec3(1, 2, 3))), 1e-6f) << "the mesh's own";
    EXPECT_EQ(r.position[i].y, 1.0f);
    EXPECT_GT(r.origin[i].y, 1.0f) << "off the face";
    EXPECT_EQ(r.origin[i].x, r.position[i].x) << "and not along the shading normal";
  }
}

TEST(Receivers, TheSideIsTheOneThatIsSeenWhateverTheNormalsSay) {
  Mesh mesh = make_box(vec3(-1.0f), vec3(1.0f));
  for (const vec3 normal : {vec3(0, 1, 0), glm::normalize(vec3(0.1f, -1, 0))}) {
    mesh.normals.assign(mesh.positions.size(), normal);
    const Receivers above = make_receivers({Camera{{0, 5, 0.01f}, vec3(0.0f), 10.0f, 3, 3, false}, vec3(1.0f)}, mesh);
    const Receivers within = make_receivers({Camera{vec3(0.0f), {0, 1, 0.01f}, 10.0f, 3, 3, false}, vec3(1.0f)}, mesh);
    for (int i = 0; i < above.size(); ++i) {
      EXPECT_GT(above.origin[i].y, 1.0f);
      EXPECT_LT(glm::distance(above.normal[i], normal), 1e-6f) << "a front shows its normal";
      EXPECT_LT(within.origin[i].y, 1.0f);
      EXPECT_LT(glm::distance(within.normal[i], -normal), 1e-6f) << "a back the other one";
    }
  }
}

}  // namespace
}  // namespace penumbra
