#include "scenes/sphere_set.h"

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

TEST(SphereSet, BoundsReachTheSurfaces) {
  const Bounds box = bounds(SphereSet{{{{1, 0, 0}, 2.0f}, {{-4, 1, 0}, 0.5f}}});
  EXPECT_EQ(box.low, vec3(-4.5f, -2, -2));
  EXPECT_EQ(box.high, vec3(3, 2, 2));
}

}  // namespace
}  // namespace penumbra
