#include "scenes/sphere_set.h"

#include <tbb/task_arena.h>

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(SphereSet, FilesRoundTrip) {
  test::TemporaryFolder folder;
  const SphereSet set{{{{0.1f, 0.2f, 0.3f}, 0.4f}, {{1, 2, 3}, 0}}};
  save_spheres(folder.path() + "/s.json", set);
  const SphereSet back = load_spheres(folder.path() + "/s.json");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back.spheres[0].centre, set.spheres[0].centre);
  EXPECT_EQ(back.spheres[0].radius, 0.4f);
}

TEST(SphereSet, BadFilesNameTheEntry) {
  test::TemporaryFolder folder;
  const auto message = [&](const std::string& text) {
    const std::string path = folder.write("s.json", text);
    return test::error_of([&] { load_spheres(path); });
  };
  EXPECT_NE(message("{").find("not valid JSON"), std::string::npos);
  EXPECT_NE(message("{\"balls\": []}").find("\"spheres\""), std::string::npos);
  EXPECT_NE(message("{\"spheres\": [[0,0,0,1],[1,2,3]]}").find("spheres[1]"), std::string::npos);
  EXPECT_NE(message("{\"spheres\": [[0,0,0,-1]]}").find("spheres"), std::string::npos);
  EXPECT_NE(message("{\"spheres\": [[0,0,1e999,1]]}").find("s.json"), std::string::npos);
}

TEST(SphereSet, FitOfABallIsTheBall) {
  const SphereSet set = fit_spheres(make_sphere({1, 2, 3}, 0.5f), 1);
  ASSERT_EQ(set.size(), 1u);
  EXPECT_LT(glm::length(set.spheres[0].centre - vec3(1, 2, 3)), 0.01f);
  EXPECT_NEAR(set.spheres[0].radius, 0.5f, 0.01f);
}

TEST(SphereSet, FitDoesNotDependOnThreads) {
  const Mesh mesh = make_torus_knot();
  SphereSet one, two;
  tbb::task_arena(1).execute([&] { one = fit_spheres(mesh, 32); });
  tbb::task_arena(2).execute([&] { two = fit_spheres(mesh, 32); });
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one.spheres[i].centre, two.spheres[i].centre);
    EXPECT_EQ(one.spheres[i].radius, two.spheres[i].radius);
  }
}

TEST(SphereSet, FitRefusesNonsense) {
  EXPECT_NE(test::error_of([] { fit_spheres(make_box(vec3(0.0f), vec3(1.0f)), 0); }).find("at least 1"),
            std::string::npos);
  EXPECT_NE(test::error_of([] { fit_spheres(Mesh{}, 4); }).find("no triangles"), std::string::npos);
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_NE(test::error_of([&] { fit_spheres(flat, 5); }).find("only yields"), std::string::npos);
}

TEST(SphereSet, FitScalesWithTheMesh) {
  Mesh small = make_torus_knot();
  for (vec3& p : small.positions) p *= 1e-3f;
  const SphereSet a = fit_spheres(make_torus_knot(), 16), b = fit_spheres(small, 16);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(b.spheres[i].radius * 1e3f, a.spheres[i].radius, 0.02f);
}

}  // namespace
}  // namespace penumbra
