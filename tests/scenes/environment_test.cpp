#include "scenes/environment.h"

#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// A smooth function on the sphere with a different value in every direction.
vec3 pattern(dvec3 d) {
  return vec3(1.5 + d.x + 0.3 * d.y * d.z, 1.2 + d.y * d.y, 1.3 + d.z - 0.2 * d.x * d.y);
}

Image lat_long_image(int w) {
  Image image{w, w / 2, {}};
  for (int y = 0; y < w / 2; ++y)
    for (int x = 0; x < w; ++x) image.pixels.push_back(pattern(LatLongMapping{w, w / 2}.direction(x + 0.5, y + 0.5)));
  return image;
}

dvec3 energy_of(const CubeMap<vec3>& cube) {
  dvec3 sum(0.0);
  for (int t = 0; t < int(cube.texels.size()); ++t) sum += dvec3(cube.texels[t]) * cube_texel_solid_angle(t, cube.n);
  return sum;
}

void expect_energy_kept(const Environment& e) {
  const dvec3 before = total_energy(e);
  for (const int n : {8, 16, 32, 64}) {
    const dvec3 after = energy_of(project(e, n));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1.0, 1e-5) << n;
  }
}

TEST(Environment, LatLongFollowsOpenEXR) {
  const LatLongMapping m{8, 4};
  const auto expect = [](dvec3 a, dvec3 b) { EXPECT_LT(glm::length(a - b), 1e-12); };
  expect(m.direction(4, 2), {0, 0, 1});   // longitude 0 in the middle: +Z
  expect(m.direction(2, 2), {1, 0, 0});   // longitude pi / 2
  expect(m.direction(0, 2), {0, 0, -1});  // longitude pi at the left edge
  expect(m.direction(3, 0), {0, 1, 0});   // +Y on top
}

TEST(Environment, LatLongProjectionKeepsEnergy) {
  Environment e = environment_from_image(lat_long_image(256), Layout::automatic, "test");
  expect_energy_kept(e);
  e.rotation = 0.7;
  expect_energy_kept(e);
  e.radiance[100 * 256 + 37] = vec3(1e6f);  // a sun of one texel
  expect_energy_kept(e);
}

TEST(Environment, CoarseSourcesKeepEnergyToo) {
  expect_energy_kept(environment_from_image(lat_long_image(4), Layout::automatic, "test"));
  expect_energy_kept(environment_from_image(lat_long_image(2), Layout::automatic, "test"));
}

TEST(Environment, ProjectionFollowsTheFunction) {
  const CubeMap<vec3> cube = project(environment_from_image(lat_long_image(512), Layout::automatic, "test"), 16);
  for (int t = 0; t < 6 * 256; ++t)
    ASSERT_LT(glm::length(cube.texels[t] - pattern(dvec3(cube_texel_direction(t, 16)))), 0.03f) << t;
}

TEST(Environment, ConstantLatLongStaysConstantPerTexel) {
  Environment e =
      environment_from_image({512, 256, std::vector<vec3>(512 * 256, vec3(1.0f))}, Layout::automatic, "test");
  for (const double rotation : {0.0, 0.3, -2.0}) {
    e.rotation = rotation;
    for (const int n : {16, 32})
      for (const vec3& texel : project(e, n).texels) ASSERT_NEAR(texel.x, 1.0f, 1e-3f) << n << " " << rotation;
  }
}

TEST(Environment, ConstantCubeStaysExactlyConstant) {
  for (const int n : {16, 32, 64})
    for (const vec3& texel : project(test::constant_environment(), n).texels) ASSERT_NEAR(texel.x, 1.0f, 1e-6f);
}

// The cross is what a camera sees that looks at -Z: continuous across every fold.
Image cross_image(int n) {
  Image image{3 * n, 4 * n, std::vector<vec3>(std::size_t(12) * n * n, vec3(0.0f))};
  const auto fill = [&](int column, int row, auto direction) {
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        image.pixels[std::size_t(row * n + y) * 3 * n + column * n + x] =
            pattern(glm::normalize(dvec3(direction(double(cube_centre(x, n)), double(cube_centre(y, n))))));
  };
  fill(1, 0, [](double u, double v) { return dvec3(u, 1, -v); });
  fill(0, 1, [](double u, double v) { return dvec3(-1, -v, -u); });
  fill(1, 1, [](double u, double v) { return dvec3(u, -v, -1); });
  fill(2, 1, [](double u, double v) { return dvec3(1, -v, u); });
  fill(1, 2, [](double u, double v) { return dvec3(u, -1, v); });
  fill(1, 3, [](double u, double v) { return dvec3(u, v, 1); });
  return image;
}

Image strip_image(int n) {
  Image image{6 * n, n, std::vector<vec3>(std::size_t(6) * n * n)};
  for (int t = 0; t < 6 * n * n; ++t)
    image.pixels[std::size_t(t / n % n) * 6 * n + t / (n * n) * n + t % n] = pattern(dvec3(cube_texel_direction(t, n)));
  return image;
}

Image angular_image(int n) {  // Debevec: centre -Z, radius proportional to the angle
  Image image{n, n, {}};
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const double u = (2 * x + 1.0) / n - 1, v = 1 - (2 * y + 1.0) / n, r = std::hypot(u, v);
      image.pixels.push_back(r > 1 ? vec3(0.0f)
                                   : pattern({u / r * std::sin(pi * r), v / r * std::sin(pi * r), -std::cos(pi * r)}));
    }
  return image;
}

TEST(Environment, EveryLayoutGivesTheSameLight) {
  const CubeMap<vec3> wanted = project(environment_from_image(lat_long_image(512), Layout::automatic, "test"), 16);
  const auto expect_same = [&](const Environment& e, float tolerance) {
    const CubeMap<vec3> cube = project(e, 16);
    for (int t = 0; t < 6 * 256; ++t) ASSERT_LT(glm::length(cube.texels[t] - wanted.texels[t]), tolerance) << t;
  };
  expect_same(environment_from_image(cross_image(64), Layout::automatic, "cross"), 0.02f);
  expect_same(environment_from_image(strip_image(64), Layout::automatic, "strip"), 0.02f);
  expect_same(environment_from_image(angular_image(256), Layout::angular, "angular"), 0.05f);
}

TEST(Environment, EveryLayoutKeepsEnergy) {
  expect_energy_kept(environment_from_image(cross_image(24), Layout::automatic, "cross"));
  expect_energy_kept(environment_from_image(strip_image(24), Layout::automatic, "strip"));
  Environment angular = environment_from_image(angular_image(128), Layout::angular, "angular");
  expect_energy_kept(angular);
  Image white{128, 128, std::vector<vec3>(128 * 128, vec3(1.0f))};
  EXPECT_NEAR(total_energy(environment_from_image(white, Layout::angular, "white")).x / (4 * pi), 1.0, 1e-3);
}

TEST(Environment, QuarterTurnPermutesFaces) {
  Environment e = environment_from_image(lat_long_image(256), Layout::automatic, "test");
  const CubeMap<vec3> rest = project(e, 16);
  e.rotation = pi / 2;  // about +y: what was at +Z is now at +X
  const CubeMap<vec3> turned = project(e, 16);
  for (int t = 0; t < 6 * 256; ++t) {
    const vec3 d = cube_texel_direction(t, 16);
    ASSERT_LT(glm::length(turned.texels[t] - rest.texels[cube_texel({-d.z, d.y, d.x}, 16)]), 2e-3f) << t;
  }
}

// Hard case 18: bad texels are repaired and counted before anything sees them.
TEST(Environment, BadTexelsAreCounted) {
  std::vector<vec3> texels(10, vec3(2.0f));
  texels[1].y = NAN;
  texels[2] = vec3(-1.0f);
  texels[3].z = INFINITY;
  const SanitizeCounts counts = sanitize(texels);
  EXPECT_EQ(counts.nan, 1u);
  EXPECT_EQ(counts.negative, 3u);
  EXPECT_EQ(counts.infinite, 1u);
  EXPECT_EQ(texels[1], vec3(2, 0, 2));
  EXPECT_EQ(texels[2], vec3(0.0f));
  EXPECT_EQ(texels[3], vec3(2.0f));
  EXPECT_FALSE(sanitize(texels));
}

TEST(Environment, UnknownProportionsAreAnError) {
  const std::string message = test::error_of([] {
    environment_from_image({5, 5, std::vector<vec3>(25)}, Layout::automatic, "square.exr");
  });
  EXPECT_NE(message.find("square.exr"), std::string::npos);
  EXPECT_NE(message.find("angular"), std::string::npos);
}

TEST(Environment, FilesRoundTripAndDamageIsNoticed) {
  test::TemporaryFolder folder;
  const Image image = lat_long_image(64);
  save_exr(folder.path() + "/light.exr", image);
  EXPECT_EQ(load_environment(folder.path() + "/light.exr").radiance, image.pixels);
  const std::string bytes = test::read_text(folder.path() + "/light.exr");
  folder.write("cut.exr", bytes.substr(0, bytes.size() / 2));
  EXPECT_NE(test::error_of([&] { load_environment(folder.path() + "/cut.exr"); }).find("cut.exr"), std::string::npos);
  folder.write("text.exr", "not an image");
  EXPECT_NE(test::error_of([&] { load_environment(folder.path() + "/text.exr"); }).find("text.exr"), std::string::npos);
  EXPECT_NE(test::error_of([&] { load_environment(folder.path() + "/none.exr"); }).find("no such"), std::string::npos);
}

// Faces as OpenEXR's ImfEnvmap.cpp puts them, written from its pixelPosition and direction.
TEST(Environment, OpenEXRSaysHowItCoversTheSphere) {
  constexpr int n = 32;
  Image cube{n, 6 * n, {}, Envmap::cube};
  for (int face = 0; face < 6; ++face)
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) {
        const double a = double(cube_centre(column, n)), b = double(cube_centre(row, n));
        const dvec3 directions[6] = {{1, -b, a}, {-1, -b, -a}, {a, 1, -b}, {a, -1, b}, {-a, -b, 1}, {a, -b, -1}};
        cube.pixels.push_back(pattern(glm::normalize(directions[face])));
      }
  const CubeMap<vec3> wanted = project(environment_from_image(lat_long_image(512), Layout::automatic, "test"), 16);
  const CubeMap<vec3> got = project(environment_from_image(cube, Layout::automatic, "cube.exr"), 16);
  for (int t = 0; t < 6 * 256; ++t) ASSERT_LT(glm::length(got.texels[t] - wanted.texels[t]), 0.02f) << t;
  cube = {5, 5, std::vector<vec3>(25), Envmap::cube};
  EXPECT_NE(test::error_of([&] { environment_from_image(cube, Layout::automatic, "x"); }).find("6n"),
            std::string::npos);
  const Image odd{6, 4, std::vector<vec3>(24), Envmap::lat_long};
  EXPECT_EQ(environment_from_image(odd, Layout::automatic, "x").mapping, Mapping::lat_long);
}

TEST(Environment, LayerOfAScene) {
  test::TemporaryFolder folder;
  ChannelImage layers{2, 1, {"a.B", "a.G", "a.R", "b.B", "b.G", "b.R"}, {}, {}};
  for (int i = 0; i < 2; ++i) layers.values.insert(layers.values.end(), {1, 2, 3, 4, 5, 6});
  save_channels(folder.path() + "/layers.exr", layers);
  const auto load = [&](const std::string& light) {
    return load_scene(folder.write("s.toml",
                                   "name = 's'\n[occluder]\nmesh = 'none'\n[receivers]\n"
                                   "plane = { half_extent = 1.0, resolution = 2 }\n[light]\n" +
                                       light));
  };
  const Scene scene = load("environment = 'layers.exr'\nlayer = 'b'\n");
  EXPECT_EQ(std::get<Environment>(scene.light).radiance[0], vec3(6, 5, 4));
  const auto expect_error = [&](const std::string& light, const std::vector<std::string>& parts) {
    const std::string message = test::error_of([&] { load(light); });
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect_error("environment = 'layers.exr'\n", {"light.environment", "layers.exr", "a, b", "layer = "});
  expect_error("environment = 'layers.exr'\nlayer = 'c'\n", {"'c'", "a, b"});
  expect_error("environment = 'layers.exr'\nlayer = ''\n", {"light.layer"});
  expect_error("environment = 'constant'\nlayer = 'b'\n", {"light.layer", "'constant'"});
}

TEST(Environment, DirectionsFillTheirTexelEvenly) {
  for (const auto& e : {environment_from_image(lat_long_image(16), Layout::automatic, "a"),
                        environment_from_image(strip_image(4), Layout::automatic, "b")}) {
    double worst = 0.0;
    for (int t = 0; t < e.width * e.height; ++t) {
      double integral = 0.0;  // of 1 / pdf over the unit square: the solid angle
      for (int k = 0; k < 400; ++k) {
        float pdf;
        e.direction(t, (float(k % 20) + 0.5f) / 20, (float(k / 20) + 0.5f) / 20, &pdf);
        integral += 1.0 / double(pdf) / 400;
      }
      worst = std::max(worst, std::abs(integral / e.solid_angle(t) - 1.0));
    }
    EXPECT_LT(worst, 2e-3);
  }
}

}  // namespace
}  // namespace penumbra
