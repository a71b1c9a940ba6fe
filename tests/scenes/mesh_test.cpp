#include "scenes/mesh.h"

#include <map>

#include "scenes/assets.h"
#include "scenes/ray_scene.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// Signed volume by the divergence theorem: positive for closed meshes whose triangles face outward.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const uvec3& t : mesh.triangles)
    sum += glm::dot(dvec3(mesh.positions[t.x]), glm::cross(dvec3(mesh.positions[t.y]), dvec3(mesh.positions[t.z]))) / 6;
  return sum;
}

bool closed(const Mesh& mesh) {
  std::map<std::pair<unsigned, unsigned>, int> edges;
  for (const uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}], --edges[{t[(k + 1) % 3], t[k]}];
  return std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; });
}

TEST(Shapes, ClosedOnesAreClosedAndFaceOutward) {
  EXPECT_NEAR(volume(make_box({-1, 0, 2}, {1, 3, 4})), 12.0, 1e-9);
  EXPECT_NEAR(volume(make_sphere({1, 2, 3}, 0.5f)), 4.0 / 3.0 * pi * 0.125, 5e-4);
  EXPECT_NEAR(volume(make_torus(1.0f, 0.25f, 96, 48)), 2 * pi * pi * 0.0625, 1e-2);
  EXPECT_GT(volume(make_torus_knot()), 0.0);
  for (const Mesh& mesh :
       {make_box(vec3(0.0f), vec3(1.0f)), make_sphere(vec3(0.0f), 1), make_torus_knot(), make_torus(1, 0.3f, 32, 16)})
    EXPECT_TRUE(closed(mesh));
}

TEST(Shapes, BowlIsOpenAndFacesInward) {
  const Mesh bowl = make_bowl(1.0f);
  EXPECT_FALSE(closed(bowl));
  const auto normals = vertex_normals(bowl);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_LE(bowl.positions[i].y, 1e-6f);
    EXPECT_NEAR(glm::dot(normals[i], bowl.positions[i]), -1.0f, 0.05f);
  }
}

TEST(Shapes, PrimitivesDependOnTheirSeedAlone) {
  const Mesh a = make_primitives(7), b = make_primitives(7), c = make_primitives(8);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_NE(a.positions, c.positions);
  EXPECT_EQ(a.positions[0], make_primitives(7, 3).positions[0]);
  const Bounds box = bounds(a);
  EXPECT_GT(box.low.y, -0.2f);
  EXPECT_LT(box.high.y, 2.2f);
  EXPECT_LT(std::max({box.high.x, -box.low.x, box.high.z, -box.low.z}), 2.2f);
}

TEST(Shapes, FoliageIsClosedAndDependsOnItsSeedAlone) {
  const Mesh a = make_foliage(7), b = make_foliage(7), c = make_foliage(8);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_NE(a.positions, c.positions);
  EXPECT_TRUE(closed(a));
  const std::size_t leaf = 8;  // triangles; the last part that grew is one
  Mesh last = a;
  last.triangles.erase(last.triangles.begin(), last.triangles.end() - std::ptrdiff_t(leaf));
  EXPECT_GT(volume(last), 0.0);
  EXPECT_TRUE(closed(last));
  const Bounds box = bounds(a);
  EXPECT_GT(box.low.y, -0.2f);
  EXPECT_GT(box.high.y, 1.5f);
  EXPECT_LT(box.high.y, 2.6f);
}

TEST(Shapes, OnesOfFlatFacesHaveTheirNormals) {
  for (const char* name : {"fence", "two-blockers"}) {
    Mesh mesh;
    ASSERT_TRUE(make_shape(name, mesh));
    for (const vec3& n : vertex_normals(mesh))
      EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-5);
  }
}

TEST(Shapes, UnknownNameIsNotAShape) {
  Mesh mesh;
  EXPECT_FALSE(make_shape("teapot", mesh));
  EXPECT_TRUE(make_shape("none", mesh));
  EXPECT_TRUE(mesh.empty());
}

TEST(Mesh, FitScalesCentresAndGrounds) {
  const Mesh box = make_box({1, 1, 1}, {2, 3, 5});
  const Similarity fit = fit_to(bounds(widened(box)), 1.0, true);
  EXPECT_EQ(fit.scale, 0.5);
  EXPECT_EQ(fit({1.5, 1, 3}), dvec3(0, 0, 0));
  EXPECT_EQ(fit({1.5, 3, 3}), dvec3(0, 1, 0));
  EXPECT_EQ(fit_to(bounds(widened(box)), 0.0, false).scale, 1.0);
}

/// One vertex of a triangle of area 2 that faces up and of one of area 1/2 that faces along x.
TEST(Mesh, VertexNormalsAreWeightedByArea) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 2}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  const vec3 expected = glm::normalize(vec3(0.5f, 2.0f, 0.0f)), found = vertex_normals(mesh)[0];
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-6f);
  mesh.normals = {{0, 0, 1}, {}, {}, {}, {}};
  EXPECT_EQ(vertex_normals(mesh)[0], vec3(0, 0, 1)) << "its own comes first";
  EXPECT_EQ(vertex_normals(mesh)[1], vec3(0, 1, 0));
}

TEST(Mesh, ObjAndPlyLoad) {
  test::TemporaryFolder folder;
  const std::string obj = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
  EXPECT_EQ(load_mesh(obj).triangles.size(), 2u);
  EXPECT_EQ(load_mesh(obj).positions.size(), 4u);
  const std::string ply = folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  EXPECT_EQ(load_mesh(ply).triangles.size(), 2u);
}

TEST(Mesh, AssetsLoad) {
  for (const char* name : {"bunny", "horse", "cat"}) {
    const Mesh mesh = load_mesh(asset_file(name, "mesh"));
    EXPECT_GT(mesh.triangles.size(), 1000u) << name;
    EXPECT_GT(mesh.triangles.size(), mesh.positions.size()) << name << ": equal vertices must be joined";
  }
}

TEST(Mesh, BadFilesSayWhatIsWrong) {
  test::TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& text) {
    const std::string path = folder.write(name, text);
    return test::error_of([&] { load_mesh(path); });
  };
  EXPECT_NE(message("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n").find("nan.obj"), std::string::npos);
  EXPECT_NE(message("empty.obj", "").find("empty.obj"), std::string::npos);
  EXPECT_NE(message("points.obj", "v 0 0 0\nv 1 0 0\n").find("points.obj"), std::string::npos);
  EXPECT_NE(message("text.ply", "hello").find("text.ply"), std::string::npos);
  EXPECT_NE(test::error_of([] { load_mesh("/nowhere/x.obj"); }).find("no such mesh"), std::string::npos);
  Mesh bad = make_box(vec3(0.0f), vec3(1.0f));
  bad.positions[3].y = NAN;
  EXPECT_NE(test::error_of([&] { validate(bad, "box"); }).find("vertex 3"), std::string::npos);
  bad = make_box(vec3(0.0f), vec3(1.0f));
  bad.triangles[0].x = 99;
  EXPECT_NE(test::error_of([&] { validate(bad, "box"); }).find("99"), std::string::npos);
}

TEST(RayScene, PacketsAgreeWithSingleRays) {
  const Mesh mesh = make_torus_knot();
  const RayScene rays(mesh);
  RayPacket packet = {};
  int hits = 0;
  for (int group = 0; group < 500; ++group) {
    for (const int count : {16, 7, 1}) {
      for (int i = 0; i < count; ++i) {
        const float a = float(group * 16 + i);
        packet.set(i, 2.0f * vec3(std::sin(a), std::cos(1.7f * a), std::sin(0.3f * a)),
                   glm::normalize(vec3(std::sin(3.1f * a), std::sin(2.3f * a), std::cos(a))), i % 2 ? 1.5f : 1e9f);
      }
      const unsigned bits = rays.occluded(packet, count), box = rays.meets_box(packet, count);
      for (int i = 0; i < count; ++i) {
        const auto at = [&](const float(&v)[3][16]) { return vec3(v[0][i], v[1][i], v[2][i]); };
        const bool single = rays.occluded(at(packet.origin), at(packet.direction), packet.far[i]);
        ASSERT_EQ(single, (bits >> i & 1u) != 0);
        if (single) ASSERT_TRUE(box >> i & 1u) << "the box must not drop a hit";
        hits += single;
      }
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(RayScene, EmptyMeshBlocksNothing) {
  const RayScene rays{Mesh{}};
  EXPECT_FALSE(rays.occluded(vec3(0.0f), {0, 1, 0}, 1e9f));
  EXPECT_FALSE(rays.intersect(vec3(0.0f), {0, 1, 0}));
}

TEST(RayScene, RaysThatAreNoNumbersMeetNothing) {
  const RayScene rays(make_box(vec3(-1.0f), vec3(1.0f)));
  for (const float bad : {NAN, INFINITY, -INFINITY})
    for (int c = 0; c < 6; ++c) {
      vec3 from(0.1f, 0.2f, -5.0f), towards(0.0f, 0.0f, 1.0f);
      RayPacket packet = {};
      packet.set(0, from, towards, INFINITY);
      (c < 3 ? from[c] : towards[c - 3]) = bad;
      packet.set(1, from, towards, INFINITY);
      EXPECT_FALSE(rays.occluded(from, towards, INFINITY)) << c;
      EXPECT_FALSE(rays.intersect(from, towards)) << c;
      EXPECT_EQ(rays.occluded(packet, 2), 1u) << c;
      float distance[RayPacket::size];
      rays.first_hits(packet, 2, distance);
      EXPECT_NEAR(distance[0], 4.0f, 1e-5f);
      EXPECT_EQ(distance[1], INFINITY) << c;
    }
}

TEST(RayScene, NearestPointOfABox) {
  const RayScene rays(make_box(vec3(-1.0f), vec3(1.0f)));
  const auto expect = [&](vec3 from, vec3 to) {
    const Nearest found = rays.nearest(from, 10.0f);
    EXPECT_NEAR(found.distance, glm::distance(from, to), 1e-6f);
    EXPECT_LT(glm::distance(found.point, to), 1e-6f);
  };
  expect({3, 0.2f, 0.1f}, {1, 0.2f, 0.1f});          // face
  expect({3, 4, 0.1f}, {1, 1, 0.1f});                // edge
  expect({-2, -3, 2}, {-1, -1, 1});                  // corner
  expect({0.2f, -0.9f, 0.3f}, {0.2f, -1.0f, 0.3f});  // from inside
  EXPECT_FALSE(std::isfinite(rays.nearest({3, 0, 0}, 1.9f).distance)) << "farther than asked for";
}

TEST(RayScene, SpheresBlockExactly) {
  RayScene rays;
  rays.build(SphereSet{{{{0, 3, 0}, 1.0f}, {{5, 0, 0}, 0.0f}, {{0, 0, -4}, 2.0f}}});
  const float grazing = std::asin(1.0f / 3.0f);
  for (const float shift : {-1e-3f, 1e-3f}) {
    const float angle = grazing + shift;
    EXPECT_EQ(rays.occluded(vec3(0.0f), {std::sin(angle), std::cos(angle), 0}, 100.0f), shift < 0.0f);
  }
  EXPECT_FALSE(rays.occluded(vec3(0.0f), {1, 0, 0}, 100.0f)) << "no radius, no shadow";
  EXPECT_FALSE(rays.occluded(vec3(0.0f), {0, 1, 0}, 1.9f)) << "ends before the sphere";
  EXPECT_TRUE(rays.occluded({0, 0, -4.5f}, {0, 1, 0}, 100.0f)) << "a receiver inside a sphere sees nothing";
  const Hit hit = rays.intersect({0, 0, 0}, {0, 0, -1});
  EXPECT_NEAR(hit.distance, 2.0f, 1e-5f);
  EXPECT_EQ(hit.triangle, 1u) << "the sphere without radius does not count";
}

TEST(RayScene, InsideVotes) {
  const RayScene rays(make_sphere(vec3(0.0f), 1.0f));
  EXPECT_TRUE(inside(rays, {0.1f, 0.2f, 0.3f}));
  EXPECT_TRUE(inside(rays, vec3(0.0f)));
  EXPECT_FALSE(inside(rays, {0.8f, 0.8f, 0.8f}));
  EXPECT_FALSE(inside(rays, {5, 0, 0}));
}

}  // namespace
}  // namespace penumbra
