#include "harness/commands/fit_picture.h"

#include "scenes/shapes.h"
#include "tests/support.h"

namespace penumbra {
namespace {

TEST(FitPicture, ShowsMeshSpheresAndWhatSticksOut) {
  const int size = 32;
  const auto grey = [](vec3 p) { return std::abs(p.x - p.y) < 1e-6f && std::abs(p.y - p.z) < 1e-6f; };
  const auto at_centre = [&](const Image& image, int panel) {
    return image.pixels[std::size_t(size / 2) * image.width + panel * size + size / 2];
  };
  const Mesh ball = make_sphere(vec3(0.0f), 1.0f, 48);
  const Image larger = draw_fit(ball, SphereSet{{{vec3(0.0f), 1.2f}}}, size);
  EXPECT_EQ(larger.width, 3 * size);
  EXPECT_TRUE(grey(at_centre(larger, 0)));
  EXPECT_FALSE(grey(at_centre(larger, 1)));
  EXPECT_FALSE(grey(at_centre(larger, 2))) << "the sphere hides the mesh";
  const Image smaller = draw_fit(ball, SphereSet{{{vec3(0.0f), 0.8f}}}, size);
  EXPECT_TRUE(grey(at_centre(smaller, 2))) << "the mesh hides the sphere";
  EXPECT_EQ(draw_fit(ball, SphereSet{}, size).pixels[0], vec3(1.0f)) << "white around";
}

}  // namespace
}  // namespace penumbra
