#include "scenes/cube_map.h"

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(CubeMap, FaceAxesAreOpenGLs) {
  EXPECT_EQ(cube_direction(0, 0.5f, 0.25f), vec3(1, -0.25f, -0.5f));
  EXPECT_EQ(cube_direction(1, 0.5f, 0.25f), vec3(-1, -0.25f, 0.5f));
  EXPECT_EQ(cube_direction(2, 0.5f, 0.25f), vec3(0.5f, 1, 0.25f));
  EXPECT_EQ(cube_direction(3, 0.5f, 0.25f), vec3(0.5f, -1, -0.25f));
  EXPECT_EQ(cube_direction(4, 0.5f, 0.25f), vec3(0.5f, -0.25f, 1));
  EXPECT_EQ(cube_direction(5, 0.5f, 0.25f), vec3(-0.5f, -0.25f, -1));
}

TEST(CubeMap, TexelCentresFindThemselves) {
  for (const int n : {1, 5, 16, 32, 64})
    for (int t = 0; t < 6 * n * n; ++t) ASSERT_EQ(cube_texel(cube_texel_direction(t, n), n), t) << n;
}

TEST(CubeMap, AnyDirectionLandsInRange) {
  for (const vec3 d :
       {vec3(0.0f), vec3(NAN), vec3(1e-30f, 0, 0), vec3(1, 1, 1), vec3(-1, -1, -1), vec3(INFINITY, 1, 1)}) {
    const int t = cube_texel(d, 32);
    EXPECT_GE(t, 0);
    EXPECT_LT(t, 6144);
  }
}

TEST(CubeMap, SolidAnglesSumToTheSphere) {
  for (const int n : {1, 16, 32, 64}) {
    double sum = 0.0;
    for (int t = 0; t < 6 * n * n; ++t) sum += cube_texel_solid_angle(t, n);
    EXPECT_NEAR(sum, 4.0 * pi, 1e-11) << n;
  }
}

TEST(CubeMap, SolidAngleRangeAt32) {
  double low = 1.0, high = 0.0;
  for (int t = 0; t < 6144; ++t) {
    low = std::min(low, cube_texel_solid_angle(t, 32));
    high = std::max(high, cube_texel_solid_angle(t, 32));
  }
  EXPECT_NEAR(low, 8.007e-4, 5e-7);
  EXPECT_NEAR(high, 3.891e-3, 5e-6);
  EXPECT_NEAR(high / low, 4.86, 0.005);
}

// Hard case 20: the unoccluded sum over 98,304 texels, one by one in float.
TEST(CubeMap, SequentialFloatSumIsGoodEnough) {
  float sum = 0.0f;
  double exact = 0.0;
  for (int t = 0; t < 6 * 128 * 128; ++t) {
    const double term = std::max(0.0, double(cube_texel_direction(t, 128).y)) * cube_texel_solid_angle(t, 128) / pi;
    sum += float(term);
    exact += term;
  }
  EXPECT_NEAR(double(sum) / exact, 1.0, 1e-5);
}

TEST(Frame, OrthonormalFrameIsOne) {
  for (const vec3 n : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(0, 1, 0), glm::normalize(vec3(1, -2, 3))}) {
    vec3 t, b;
    orthonormal_frame(n, t, b);
    EXPECT_NEAR(glm::dot(t, b), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(glm::cross(t, b), n), 1.0f, 1e-6f);
  }
}

}  // namespace
}  // namespace penumbra
