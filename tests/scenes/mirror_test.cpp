// Mirrors: where reflected rays go, by closed forms and by the mirrored camera.
#include "scenes/mirror.h"

#include <algorithm>

#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Mirror ball(vec3 centre, float radius) {
  return {Sphere{centre, radius}, true};
}
Mirror wall(vec3 centre, vec3 edge_u, vec3 edge_v) {
  return {MirrorPlane{centre, edge_u, edge_v}, true};
}

Receivers seen(const Camera& camera, Mesh mesh, const std::vector<Mirror>& mirrors) {
  add_mirrors(mesh, mirrors);
  return make_receivers({camera, vec3(1.0f), mirrors}, mesh);
}

TEST(Mirror, ReflectsAsItIsHeld) {
  const auto at = meet(wall({0, 0, -2}, {2, 0, 0}, {0, 2, 0}), vec3(0.0f), glm::normalize(vec3(0.3f, 0, -1)));
  ASSERT_TRUE(at);
  EXPECT_LT(glm::distance(at->point, vec3(0.6f, 0, -2)), 1e-6f);
  EXPECT_LT(glm::distance(at->normal, vec3(0, 0, 1)), 1e-6f);
  EXPECT_LT(glm::distance(at->direction, glm::normalize(vec3(0.3f, 0, 1))), 1e-6f);
  EXPECT_NEAR(at->distance, 2.0f * std::sqrt(1.09f), 1e-6f);
  EXPECT_FALSE(meet(wall({0, 0, -2}, {1, 0, 0}, {0, 1, 0}), vec3(0.0f), glm::normalize(vec3(0.3f, 0, -1)))) << "beside";
  EXPECT_FALSE(meet(wall({0, 0, 2}, {9, 0, 0}, {0, 9, 0}), vec3(0.0f), vec3(0, 0, -1))) << "behind";
  EXPECT_FALSE(meet(wall({0, 0, 0}, {0, 0, 0}, {0, 1, 0}), vec3(0, 0, 1), vec3(0, 0, -1))) << "no area";
  EXPECT_FALSE(meet(wall({1, 0, 0}, {0, 1, 0}, {1, 0, 0}), vec3(0.0f), vec3(1, 0, 0))) << "seen from its edge";

  // A ray that meets a unit ball at 45 degrees turns by a right angle.
  const float h = std::sqrt(0.5f);
  const auto turned = meet(ball(vec3(0.0f), 1.0f), {h, 0, 5}, {0, 0, -1});
  ASSERT_TRUE(turned);
  EXPECT_LT(glm::distance(turned->point, vec3(h, 0, h)), 1e-6f);
  EXPECT_LT(glm::distance(turned->direction, vec3(1, 0, 0)), 1e-6f);
  const auto within = meet(ball(vec3(0.0f), 1.0f), vec3(0.0f), vec3(0, 1, 0));
  ASSERT_TRUE(within);
  EXPECT_EQ(within->direction, vec3(0, -1, 0));
  EXPECT_FALSE(meet(ball(vec3(0.0f), 1.0f), {1.001f, 0, 5}, {0, 0, -1}));
  EXPECT_FALSE(meet(ball(vec3(0.0f), 0.0f), {0, 0, 5}, {0, 0, -1}));
}

/// What a wall that fills the view shows is what a camera behind it sees, mirrored from left to right.
TEST(Mirror, AWallShowsWhatACameraBehindItSees) {
  const Mesh mesh = make_box({-0.6f, 0.2f, 1.0f}, {0.3f, 1.4f, 1.8f});
  Camera camera{{0.4f, 1.1f, 0.2f}, {0.3f, 0.8f, -2.0f}, 50.0f, 24, 18};
  const Receivers shown = seen(camera, mesh, {wall({0, 1, -2}, {40, 0, 0}, {0, 40, 0})});
  camera.eye.z = -4.0f - camera.eye.z, camera.target.z = -2.0f;
  const Receivers behind = make_receivers({camera, vec3(1.0f)}, mesh);
  int found = 0;
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 24; ++x) {
      const int k = y * 24 + x, mirrored = y * 24 + 23 - x;
      // What lies in front of the wall; a corner's ray may fall on either side of it.
      if (!behind.valid(mirrored) || behind.position[mirrored].z < -1.99f) continue;
      ++found;
      const float far = behind.view_depth[mirrored];  // float rounds relative to it
      ASSERT_TRUE(shown.valid(k)) << x << " " << y;
      EXPECT_LT(glm::distance(shown.position[k], behind.position[mirrored]), 1e-5f * far) << x << " " << y;
      EXPECT_LT(glm::distance(shown.normal[k], behind.normal[mirrored]), 1e-3f) << x << " " << y;
      EXPECT_NEAR(shown.view_depth[k], behind.view_depth[mirrored], 1e-5f * far) << "the whole path";
      EXPECT_EQ(shown.on_occluder[k], behind.on_occluder[mirrored]);
    }
  EXPECT_GT(found, 200);
}

/// The middle of a ball shows what stands behind the camera.
TEST(Mirror, ABallShowsWhatStandsBehindTheCamera) {
  const Camera camera{{0, 1, 4}, {0, 1, 0}, 40.0f, 33, 33, false};
  const Receivers r = seen(camera, make_box({-3, -2, 9}, {3, 4, 10}), {ball({0, 1, 0}, 1.0f)});
  const int middle = 16 * 33 + 16;
  EXPECT_LT(glm::distance(r.position[middle], vec3(0, 1, 9)), 1e-4f);
  EXPECT_LT(r.normal[middle].z, -0.99f) << "smooth, but of the face that looks at the ball";
  EXPECT_NEAR(r.view_depth[middle], 3.0f + 8.0f, 1e-4f);
  EXPECT_FALSE(r.valid(0)) << "beside the ball nothing is seen";
}

TEST(Mirror, BehindASecondMirrorNothingIsSeen) {
  const Camera camera{{0, 1, 0}, {0, 1, -1}, 30.0f, 9, 9};
  const std::vector<Mirror> facing = {wall({0, 1, -2}, {20, 0, 0}, {0, 20, 0}),
                                      wall({0, 1, 3}, {20, 0, 0}, {0, 20, 0})};
  const Receivers r = seen(camera, {}, facing);
  for (int k = 0; k < r.size(); ++k)  // the ground between the walls is seen, the walls in each other are not
    EXPECT_TRUE(!r.valid(k) || (r.position[k].z >= -2.0f && r.position[k].z <= 3.0f));
  EXPECT_FALSE(r.valid(4 * 9 + 4));
  const Receivers inside = seen(camera, {}, {ball({0, 1, 0}, 0.5f)});
  EXPECT_EQ(std::count_if(inside.normal.begin(), inside.normal.end(), [](vec3 n) { return n != vec3(0.0f); }), 0);
}

/// Mirrors that lie on a surface hide it, and what stands on a mirror is seen in it down to its foot.
TEST(Mirror, OnASurfaceAMirrorIsWhatIsSeen) {
  const Mesh box = make_box({-0.5f, 0.0f, -1.0f}, {0.5f, 1.0f, 0.0f});
  const Camera camera{{0, 1.0f, 3.0f}, {0, 0.0f, 0.4f}, 40.0f, 21, 21};
  const Receivers r = seen(camera, box, {wall({0, 0, 0}, {100, 0, 0}, {0, 0, 100})});
  int on_box = 0;
  for (int k = 0; k < r.size(); ++k) {
    EXPECT_TRUE(!r.valid(k) || r.on_occluder[k]) << "the ground is a mirror, and shows the box or the sky";
    on_box += r.valid(k) && r.position[k].y < 0.05f;
  }
  EXPECT_GT(on_box, 2) << "the foot of the box, directly or reflected";
}

/// Light is blocked by a mirror unless the file says otherwise; either way the picture of it is the same.
TEST(Mirror, BlocksLightUnlessItIsToldNotTo) {
  const auto file = [](const std::string& more, const std::string& occluder = "mesh = \"box\"\n",
                       const std::string& rest = "") {
    return "name = \"m\"\n[occluder]\n" + occluder +
           "[receivers]\ncamera = { eye = [0, 2, 5], target = [0, 0.5, 0], width = 32, height = 24 }\n"
           "[light]\nenvironment = \"constant\"\n[[mirror]]\nsphere = { centre = [1, 0.5, 1], radius = 0.5 }\n" +
           more + rest;
  };
  const test::TemporaryFolder folder;
  const auto load = [&](const std::string& text) { return load_scene(folder.write("m.toml", text)); };
  const Scene blocking = load(file("")), open = load(file("shadow = false\n"));
  EXPECT_GT(blocking.mesh.triangles.size(), open.mesh.triangles.size());
  EXPECT_EQ(open.mesh.triangles.size(), 12u);
  EXPECT_EQ(blocking.receivers.position, open.receivers.position);
  EXPECT_EQ(blocking.receivers.normal, open.receivers.normal);
  EXPECT_EQ(bounds(blocking.mesh).high.x, 1.5f);

  const std::string twist = "[motion]\nkind = \"twist\"\n", turning = "[motion]\nkind = \"rotate-light\"\n";
  const std::string spheres = "mesh = \"box\"\nspheres = [[0, 0, 0, 0.5]]\n";
  const auto error = [&](const std::string& text) { return test::error_of([&] { load(text); }); };
  EXPECT_EQ(error(file("", "mesh = \"box\"\n", twist)), "");
  EXPECT_NE(error(file("", spheres)).find("shadow = false"), std::string::npos);
  EXPECT_EQ(error(file("", "mesh = \"box\"\n", turning)), "");
  EXPECT_EQ(error(file("shadow = false\n", spheres, twist)), "");
  EXPECT_NE(error(file("plane = { centre = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }\n")).find("exactly one"),
            std::string::npos);
}

TEST(Mirror, MistakesAreNamed) {
  const test::TemporaryFolder folder;
  const auto error = [&](const std::string& receivers, const std::string& mirror) {
    return test::error_of([&] {
      load_scene(folder.write("m.toml", "[occluder]\nmesh = \"box\"\n[receivers]\n" + receivers +
                                            "[light]\nenvironment = \"constant\"\n" + mirror));
    });
  };
  const std::string camera = "camera = { eye = [0, 2, 5], target = [0, 0, 0], width = 4, height = 4 }\n";
  const std::string plane = "plane = { half_extent = 1.0, resolution = 4 }\n";
  const std::string good = "[[mirror]]\nsphere = { centre = [1, 0.5, 1], radius = 0.5 }\n";
  EXPECT_EQ(error(camera, good), "");
  EXPECT_NE(error(plane, good).find("camera"), std::string::npos);
  EXPECT_NE(error(camera, "[[mirror]]\n").find("exactly one of sphere, plane"), std::string::npos);
  EXPECT_NE(error(camera, "[mirror]\n").find("[[mirror]]"), std::string::npos);
  EXPECT_NE(error(camera, "[[mirror]]\nsphere = { centre = [1, 0, 1], radius = 0 }\n").find("radius"),
            std::string::npos);
  EXPECT_NE(error(camera, "[[mirror]]\nsphere = { centre = [1, 0, nan], radius = 1 }\n"), "");
  EXPECT_NE(error(camera, "[[mirror]]\nplane = { centre = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [-2, 0, 0] }\n")
                .find("parallel"),
            std::string::npos);
}

}  // namespace
}  // namespace penumbra
