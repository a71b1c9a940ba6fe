#include "scenes/receivers.h"

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(Receivers, PlaneRunsRightAndDown) {
  const Receivers r = make_receivers({PlaneGrid{2.0f, 4, 0.5f}, vec3(0.8f)}, {});
  ASSERT_EQ(r.size(), 16);
  EXPECT_EQ(r.position[0], vec3(-1.5f, 0.5f, -1.5f));
  EXPECT_EQ(r.position[1], vec3(-0.5f, 0.5f, -1.5f));
  EXPECT_EQ(r.position[4], vec3(-1.5f, 0.5f, -0.5f));
  EXPECT_EQ(r.normal[7], vec3(0, 1, 0));
  EXPECT_EQ(r.albedo[7], vec3(0.8f));
}

TEST(Receivers, VerticesCarryNormals) {
  const Mesh mesh = make_sphere(vec3(0.0f), 2.0f, 48);
  const Receivers r = make_receivers({MeshVertices{}, vec3(1.0f)}, mesh);
  ASSERT_EQ(r.size(), int(mesh.positions.size()));
  for (int i = 0; i < r.size(); ++i) {
    EXPECT_NEAR(glm::dot(r.normal[i], r.position[i]), 2.0f, 0.02f);
    EXPECT_EQ(r.on_occluder[i], 1);
  }
}

TEST(Receivers, CameraSeesMeshGroundAndNothing) {
  Camera camera{{0, 1, 5}, {0, 1, 0}, 60.0f, 65, 65};
  const Receivers r = make_receivers({camera, vec3(1.0f)}, make_sphere({0, 1, 0}, 1.0f));
  const int middle = 32 * 65 + 32;
  EXPECT_NEAR(r.view_depth[middle], 4.0f, 1e-3f);
  EXPECT_NEAR(r.position[middle].z, 1.0f, 1e-3f);
  EXPECT_NEAR(r.normal[middle].z, 1.0f, 1e-3f);
  EXPECT_EQ(r.on_occluder[middle], 1);
  const int below = 64 * 65 + 32;
  EXPECT_NEAR(r.position[below].y, 0.0f, 1e-5f);
  EXPECT_EQ(r.normal[below], vec3(0, 1, 0));
  EXPECT_EQ(r.on_occluder[below], 0);
  EXPECT_FALSE(r.valid(32)) << "the sky shows nothing";
  EXPECT_TRUE(std::isinf(r.view_depth[32]));
  camera.has_ground = false;
  EXPECT_FALSE(make_receivers({camera, vec3(1.0f)}, make_sphere({0, 1, 0}, 1.0f)).valid(below));
}

/// Looking straight down from 1 m, 90 degrees high: two metres of ground in ten rows, and three times that in columns.
TEST(Receivers, PixelsOfACameraAreSquare) {
  Camera camera;
  camera.eye = {0, 1, 0}, camera.target = vec3(0.0f);
  camera.vertical_fov = 90.0f;
  camera.width = 30, camera.height = 10;
  camera.has_ground = true;
  const Receivers r = make_receivers({camera, vec3(1.0f)}, {});
  const auto at = [&](int x, int y) { return r.position[std::size_t(y * 30 + x)]; };
  EXPECT_NEAR(glm::distance(at(0, 0), at(29, 0)), 29 * 0.2f, 1e-4f);
  EXPECT_NEAR(glm::distance(at(0, 0), at(0, 9)), 9 * 0.2f, 1e-4f);
  EXPECT_LT(glm::length(at(14, 4) + at(15, 5)), 1e-5f) << "the middle of the image is the target";
}

TEST(Animation, MovesTheCamera) {
  Scene scene;
  scene.receiver_spec.kind = Camera{{0, 1, 4}, {0, 1, 0}, 40.0f, 9, 9, false};
  scene.mesh = make_sphere({0, 1, 0}, 1.0f);
  scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
  const int middle = 4 * 9 + 4;
  scene.motion = {Motion::Kind::dolly, float(std::log(2.0)), 4.0f, 4};
  Animation nearer(scene);
  EXPECT_NEAR(nearer.frame(0).receivers.view_depth[middle], 3.0f, 1e-3f);
  EXPECT_NEAR(nearer.frame(1).receivers.view_depth[middle], 7.0f, 1e-3f) << "twice as far from the target";
  EXPECT_NEAR(nearer.frame(3).receivers.view_depth[middle], 1.0f, 1e-3f) << "and half as far";
  scene.motion = {Motion::Kind::orbit, float(pi / 2), 4.0f, 4};
  Animation around(scene);
  const Frame turned = around.frame(1);
  EXPECT_LT(glm::distance(turned.receivers.position[middle], vec3(1, 1, 0)), 1e-3f);
  EXPECT_TRUE(turned.changed.receivers);
  EXPECT_FALSE(turned.changed.mesh || turned.changed.light || turned.changed.spheres);
  EXPECT_EQ(std::get<Camera>(around.receiver_spec(1).kind).target, vec3(0, 1, 0));
}

TEST(Animation, MovesWhatTheSceneSays) {
  Scene scene = test::sphere_scene({{{1, 2, 0}, 0.5f}}, test::receivers_at({{0, 0, 0}}));
  scene.motion = {Motion::Kind::rigid, float(pi / 2), 4.0f, 4};
  Animation animation(scene);
  EXPECT_LT(glm::distance(animation.frame(0).spheres.spheres[0].centre, vec3(1, 2, 0)), 1e-5f);
  const Frame turned = animation.frame(1);  // sin(2 pi / 4) = 1: a quarter turn about +y takes +x to -z
  EXPECT_LT(glm::length(turned.spheres.spheres[0].centre - vec3(0, 2, -1)), 1e-5f);
  EXPECT_TRUE(turned.changed.mesh && turned.changed.spheres);
  EXPECT_FALSE(turned.changed.light);

  scene.motion = {Motion::Kind::twist, 1.0f, 4.0f, 4};
  Animation twist(scene);
  const Frame twisted = twist.frame(1);
  const Bounds rest = bounds(scene.mesh);
  for (std::size_t i = 0; i < scene.mesh.positions.size(); ++i) {
    EXPECT_FLOAT_EQ(twisted.mesh.positions[i].y, scene.mesh.positions[i].y);
    if (scene.mesh.positions[i].y < rest.low.y + 1e-6f)
      EXPECT_LT(glm::length(twisted.mesh.positions[i] - scene.mesh.positions[i]), 1e-5f) << "the foot stays";
  }

  scene.motion = {Motion::Kind::rotate_light, 1.0f, 10.0f, 10};
  Animation light(scene);
  EXPECT_NEAR(environment_of(light.frame(5).light)->rotation, 0.5, 1e-6);
  EXPECT_NEAR(environment_of(light.frame(0).light)->rotation, 0.0, 1e-6);
}

/// Four corners of a square of 2 m on a quarter period: the whole amount, or what of it comes to their height.
TEST(Animation, TwistsAndBendsByHand) {
  Scene scene = test::sphere_scene({}, test::receivers_at({{0, 0, 0}}));
  scene.mesh.positions = {{1, 0, 0}, {1, 2, 0}, {0, 2, 0}, {1, 1, 0}};
  scene.mesh.triangles = {{0, 1, 2}, {0, 3, 2}};
  const auto moved = [&](Motion::Kind kind, int frame, std::size_t vertex) {
    scene.motion = {kind, float(pi / 2), 8.0f, 8};
    return Animation(scene).frame(frame).mesh.positions[vertex];
  };
  const auto expect = [&](vec3 found, vec3 expected) { EXPECT_LT(glm::distance(found, expected), 1e-5f) << found.x; };
  const float half = std::sqrt(0.5f);
  expect(moved(Motion::Kind::twist, 2, 1), {0, 2, -1});        // on top all of the quarter turn: +x goes to -z
  expect(moved(Motion::Kind::twist, 2, 3), {half, 1, -half});  // half of it half-way up
  expect(moved(Motion::Kind::twist, 6, 1), {0, 2, 1});         // and back
  expect(moved(Motion::Kind::twist, 4, 1), {1, 2, 0});         // half a period: at rest
  expect(moved(Motion::Kind::bend, 2, 0), {1, 0, 0});
  expect(moved(Motion::Kind::bend, 2, 2), {-2, 0, 0});  // about +z: what stood up lies along -x
  expect(moved(Motion::Kind::bend, 2, 1), {-2, 1, 0});
  expect(moved(Motion::Kind::bend, 6, 2), {2, 0, 0});
}

TEST(Animation, NormalsOfTheMeshGoWithIt) {
  Scene scene = test::sphere_scene({}, test::receivers_at({{0, 0, 0}}));
  scene.mesh = make_torus_knot();
  scene.mesh.normals = geometric_normals(scene.mesh);
  for (const Motion::Kind kind : {Motion::Kind::rigid, Motion::Kind::twist, Motion::Kind::bend}) {
    scene.motion = {kind, 0.7f, 4.0f, 4};
    Animation animation(scene);
    const Mesh& moved = animation.frame(1).mesh;
    const std::vector<vec3> geometric = geometric_normals(moved);
    double sum = 0.0;
    for (std::size_t i = 0; i < geometric.size(); ++i) {
      EXPECT_GT(glm::dot(moved.normals[i], geometric[i]), 0.98f) << int(kind);
      sum += double(glm::distance(moved.normals[i], scene.mesh.normals[i])) / double(geometric.size());
    }
    EXPECT_GT(sum, 0.1) << "they did move";
  }
}

TEST(Animation, TurnsAboutTheCentreOfTheMotion) {
  Scene scene = test::sphere_scene({{{11, 2, 0}, 0.5f}}, test::receivers_at({{0, 0, 0}}));
  scene.light = make_disc({12, 5, 0}, {-1, -1, 0}, 1.0f, vec3(1.0f));
  scene.motion = {Motion::Kind::rigid, float(pi / 2), 4.0f, 4, Carry::rigid, vec3(10, 0, 0)};
  EXPECT_LT(glm::distance(Animation(scene).frame(1).spheres.spheres[0].centre, vec3(10, 2, -1)), 1e-4f);
  scene.motion = {Motion::Kind::rotate_light, float(2 * pi), 4.0f, 4, Carry::rigid, vec3(10, 0, 0)};
  Animation light(scene);
  EXPECT_LT(glm::distance(area_light_of(light.frame(1).light)->centre, vec3(10, 5, -2)), 1e-4f);
}

}  // namespace
}  // namespace penumbra
