#include "scenes/light.h"

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(AreaLight, RectangleShinesAlongTheCrossProductOfItsEdges) {
  const AreaLight light = make_rectangle({0, 2, 0}, {3, 0, 0}, {0, 0, 2}, vec3(1.0f));
  EXPECT_EQ(light.normal, vec3(0, -1, 0));
  EXPECT_DOUBLE_EQ(light.area(), 6.0);
  EXPECT_EQ(light.point(0, 0), vec3(-1.5f, 2, -1));
  EXPECT_EQ(light.point(0.5f, 0.5f), vec3(0, 2, 0));
}

TEST(AreaLight, DiscMapsEqualAreasToEqualAreas) {
  const AreaLight light = make_disc({1, 2, 3}, {0, -2, 0}, 0.5f, vec3(1.0f));
  EXPECT_NEAR(light.area(), pi * 0.25, 1e-6);
  int inner = 0, outside = 0;
  constexpr int n = 400;
  for (int k = 0; k < n * n; ++k) {
    const vec3 p = light.point((float(k % n) + 0.5f) / n, (float(k / n) + 0.5f) / n) - light.centre;
    EXPECT_NEAR(p.y, 0.0f, 1e-6f);
    inner += glm::length(p) < 0.25f;
    outside += glm::length(p) > 0.5f + 1e-6f;
  }
  EXPECT_EQ(outside, 0);
  EXPECT_NEAR(double(inner) / (n * n), 0.25, 0.002);  // half the radius holds a quarter of the area
}

TEST(AreaLight, LengthsThatFloatCannotSquareKeepTheirDirection) {
  for (const float length : {1e-40f, 1e-25f, 1e-13f, 1.0f, 1e15f, 1e25f, 1e38f}) {
    const AreaLight disc = make_disc({0, 2, 0}, vec3(0, length, length), 0.5f, vec3(1.0f));
    EXPECT_NEAR(disc.normal.y, std::sqrt(0.5f), 1e-6f) << length;
    EXPECT_NEAR(disc.normal.z, std::sqrt(0.5f), 1e-6f) << length;
    EXPECT_NEAR(disc.area(), 0.25 * pi, 1e-6) << length;
    const AreaLight up = make_rectangle({0, 2, 0}, {0, 0, length}, {length, 0, 0}, vec3(1.0f));
    EXPECT_EQ(up.normal, vec3(0, 1, 0)) << length;
    EXPECT_NEAR(up.area() / (double(length) * double(length)), 1.0, 1e-6) << length;
  }
}

TEST(AreaLight, WithoutASideItShinesDown) {
  for (const AreaLight& light : {make_rectangle({0, 2, 0}, {1, 2, 3}, {2, 4, 6}, vec3(1.0f)),
                                 make_rectangle({0, 2, 0}, {0.1f, 0.2f, 0.3f}, {0.3f, 0.6f, 0.9f}, vec3(1.0f)),
                                 make_rectangle({0, 2, 0}, vec3(0.0f), {1, 0, 0}, vec3(1.0f)),
                                 make_disc({0, 2, 0}, vec3(0.0f), 0.0f, vec3(1.0f))}) {
    EXPECT_EQ(light.normal, vec3(0, -1, 0));
    EXPECT_EQ(light.area(), 0.0);
  }
}

TEST(AreaLight, ZeroAreaIsAPoint) {
  const AreaLight light = make_rectangle({0, 2, 0}, vec3(0.0f), vec3(0.0f), vec3(1.0f));
  EXPECT_EQ(light.area(), 0.0);
  EXPECT_EQ(light.point(0.3f, 0.9f), vec3(0, 2, 0));
}

}  // namespace
}  // namespace penumbra
