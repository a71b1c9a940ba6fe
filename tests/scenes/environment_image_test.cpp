// Environments as pictures for other programs.
#include "scenes/environment_image.h"

#include <random>

#include "scenes/float_map.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Environment random_environment(Mapping mapping, int width, int height, double rotation) {
  std::mt19937 random(3);
  Environment e{mapping, width, height, {}, rotation};
  for (int i = 0; i < width * height; ++i) e.radiance.emplace_back(std::uniform_real_distribution<float>()(random));
  return e;
}

/// Radiance of a world direction by what LatLongImage says of itself.
vec3 look_up(const LatLongImage& light, vec3 d) {
  const double lon = std::atan2(double(d.x), double(d.z)), lat = std::asin(double(d.y));
  const double x = (light.left_edge - lon) / (2.0 * pi) * light.image.width;
  const int column = int(std::floor(x)), row = int((0.5 * pi - lat) / pi * light.image.height);
  return light.image.pixels[std::size_t(row) * light.image.width +
                            (column % light.image.width + light.image.width) % light.image.width];
}

TEST(EnvironmentImage, LatLongIsTheSameInEveryDirectionAtAnyRotation) {
  for (const double rotation : {0.0, 0.3, -2.9, 7.0, 2.0 * pi / 24, 99.0}) {
    const Environment e = random_environment(Mapping::lat_long, 24, 12, rotation);
    const LatLongImage light = as_lat_long(e);
    EXPECT_TRUE(light.exact);
    EXPECT_LE(std::abs(light.left_edge - pi), 1.000001 * pi / 24) << "half a texel";
    for (int texel = 0; texel < 24 * 12; ++texel)
      for (const float at : {0.1f, 0.5f, 0.9f})
        EXPECT_EQ(look_up(light, e.direction(texel, at, at)), e.radiance[std::size_t(texel)])
            << rotation << " " << texel;
  }
}

TEST(EnvironmentImage, CubeMapsAreResampledInPlace) {
  Environment e = random_environment(Mapping::cube, 8, 48, 0.7);
  const auto smooth = [](vec3 d) { return 1.0f + 0.5f * d.x + 0.2f * d.y - 0.3f * d.z; };
  for (int texel = 0; texel < 8 * 48; ++texel)
    e.radiance[std::size_t(texel)] = vec3(smooth(e.direction(texel, 0.5f, 0.5f)));
  const LatLongImage light = as_lat_long(e);
  EXPECT_FALSE(light.exact);
  EXPECT_EQ(light.image.width, 32);
  EXPECT_EQ(light.image.height, 16);
  EXPECT_EQ(light.left_edge, pi);
  dvec3 energy(0.0);
  const LatLongMapping mapping{32, 16};
  for (int i = 0; i < 32 * 16; ++i)
    energy += dvec3(light.image.pixels[std::size_t(i)]) * mapping.solid_angle(i % 32, i % 32 + 1, i / 32, i / 32 + 1);
  EXPECT_NEAR(energy.x, total_energy(e).x, 0.01 * total_energy(e).x);
  for (int texel = 0; texel < 8 * 48; ++texel)
    for (const float at : {0.1f, 0.5f, 0.9f}) {
      const vec3 d = e.direction(texel, at, 1.0f - at);
      EXPECT_NEAR(look_up(light, d).x, smooth(d), 0.15f) << "a texel is 0.2 wide";
    }
  for (const vec3& p : as_lat_long(test::constant_environment()).image.pixels) EXPECT_EQ(p, vec3(1.0f));
}

TEST(EnvironmentImage, FloatMapsHoldEveryBitTheRightWayUp) {
  const test::TemporaryFolder folder;
  Image image{3, 2, {{0.1f, 2e9f, -3.0f}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1e-30f, 0.5f, 0.25f}, {3, 2, 1}}};
  save_pfm(folder.path() + "/a.pfm", image);
  EXPECT_EQ(load_image(folder.path() + "/a.pfm").pixels, image.pixels) << "linear, top row first";
  std::filesystem::copy(folder.path() + "/a.pfm", folder.path() + "/a.exr");
  EXPECT_EQ(load_image(folder.path() + "/a.exr").pixels, image.pixels) << "known by its content";
  EXPECT_NE(test::error_of([&] { save_pfm(folder.path() + "/none/a.pfm", image); }).find("cannot be written"),
            std::string::npos);
}

}  // namespace
}  // namespace penumbra
