// What receivers of many normals share: groups of normals, sets of samples for all normals of a cone, and the pictures
// that come of them, over seeds against closed forms.
#include "techniques/bases/normal_table.h"

#include <random>

#include "techniques/bases/light_sampling.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// Unit vectors within an angle of an axis, even by area.
std::vector<vec3> normals_about(vec3 axis, double angle, int count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit;
  vec3 tangent, bitangent;
  orthonormal_frame(axis, tangent, bitangent);
  std::vector<vec3> normals;
  for (int k = 0; k < count; ++k) {
    const double up = 1.0 - unit(random) * (1.0 - std::cos(angle)), turn = 2.0 * pi * unit(random);
    const double out = std::sqrt(1.0 - up * up);
    normals.push_back(glm::normalize(float(up) * axis + float(out * std::cos(turn)) * tangent +
                                     float(out * std::sin(turn)) * bitangent));
  }
  return normals;
}

TEST(NormalTable, ConesHoldTheirNormals) {
  std::vector<vec3> normals = normals_about({0, 1, 0}, pi, 5000);
  normals[17] = vec3(0.0f);
  const NormalTable table = NormalTable::of(normals);
  EXPECT_LE(table.cones.size(), 384u);
  EXPECT_GT(table.cones.size(), 300u);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Cone& cone = table.cones[table.index[i]];
    EXPECT_GT(cone.cosine, std::cos(0.25f));
    EXPECT_NEAR(cone.sine * cone.sine + cone.cosine * cone.cosine, 1.0f, 1e-6f);
    if (i != 17) EXPECT_GE(glm::dot(cone.axis, normals[i]), cone.cosine);
  }
}

TEST(NormalTable, NormalsOfManyReceiversAreGroupsOfTheirOwn) {
  std::vector<vec3> normals = normals_about({0, 1, 0}, 0.2, 1000);
  for (std::size_t i = 500; i < 1000; ++i) normals[i] = vec3(0, 1, i % 2 ? 0.0f : -0.0f);
  const NormalTable table = NormalTable::of(normals);
  EXPECT_TRUE(one_normal(table.cones[0]));
  EXPECT_EQ(table.cones[0].axis, vec3(0, 1, 0));
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(table.index[i] == 0, i >= 500) << i;
  const NormalTable few = NormalTable::of({{0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(few.index, (std::vector<std::uint16_t>{0, 1, 0, 0}));
  EXPECT_EQ(few.cones.size(), 2u);
  EXPECT_TRUE(NormalTable::of({}).cones.empty());
}

/// Radiance 1 between two elevations in degrees, in texels of 1.4 degrees.
Environment band(double low, double high) {
  Environment e;
  e.mapping = Mapping::lat_long;
  e.width = 256, e.height = 128;
  e.radiance.assign(256 * 128, vec3(0.0f));
  for (int texel = 0; texel < 256 * 128; ++texel) {
    const double elevation = std::asin(double(e.direction(texel, 0.5f, 0.5f).y)) * 180.0 / pi;
    if (elevation > low && elevation < high) e.radiance[texel] = vec3(1.0f);
  }
  return e;
}

/// What arrives unoccluded, by 16 x 16 points of every texel.
double exact(const Environment& e, vec3 normal) {
  const auto at = [](int k) { return (float(k) + 0.5f) / 16.0f; };
  double sum = 0.0;
  for (int texel = 0; texel < int(e.radiance.size()); ++texel) {
    if (e.radiance[texel] == vec3(0.0f)) continue;
    double cosines = 0.0;
    for (int k = 0; k < 256; ++k)
      cosines += std::max(0.0, double(glm::dot(normal, e.direction(texel, at(k % 16), at(k / 16)))));
    sum += cosines / 256 * e.solid_angle(texel) * double(e.radiance[texel].x);
  }
  return sum / pi;
}

/// (mean - expected) over its own standard error.
double z_score(const std::vector<double>& values, double expected) {
  double mean = 0.0, squares = 0.0;
  for (const double v : values) mean += v / double(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return (mean - expected) / std::sqrt(squares / double(values.size() * (values.size() - 1)));
}

/// Light from below the horizon of the cone's axis, which only the normals that lean towards it see; and light all
/// around, which each weighs by its own cosine.
TEST(SharedSamples, AreUnbiasedForEveryNormalOfTheCone) {
  const Environment lights[] = {band(-11.5, -7.0), band(20.0, 50.0)};
  const double angle = 0.2;
  const Cone cone = {{0, 1, 0}, float(std::sin(angle)), float(std::cos(angle))};
  for (const Environment& environment : lights) {
    const Light light = environment;
    const LightSampler sampler(light);
    EnvironmentSampler::Product product;
    sampler.make_product(cone, product);
    for (const double lean : {0.0, 0.1, 0.17, 0.199}) {
      const vec3 normal(float(std::sin(lean)), float(std::cos(lean)), 0.0f);
      const double expected = exact(environment, normal);
      std::vector<double> means;
      std::vector<LightSample> shared, own;
      for (std::uint64_t stream = 0; stream < 64; ++stream) {
        sampler.draw_shared(product, 256, stream, shared);
        LightSampler::face(shared, normal, own);
        double sum = 0.0;
        for (const LightSample& s : own) sum += double(s.weight.x) / 256;
        means.push_back(sum);
      }
      if (expected == 0.0) EXPECT_EQ(*std::max_element(means.begin(), means.end()), 0.0);
      else EXPECT_LT(std::abs(z_score(means, expected)), 4.0) << lean << ", " << expected;
    }
  }
}

const vec3 cap_axis = glm::normalize(vec3(0.3f, 1, 0.1f));
constexpr double cap_angle = 0.5;

/// Receivers of many normals beneath a cap, all of it above their horizons.
Scene picture(int edge) {
  const auto count = std::size_t(edge) * edge;
  Scene scene =
      test::sphere_scene({test::cap_sphere(cap_axis, cap_angle)}, test::receivers_at(std::vector<vec3>(count)));
  scene.receivers.normal = normals_about(cap_axis, 1.0, int(count));
  scene.receivers.width = scene.receivers.height = edge;
  return scene;
}

/// What one of them gets of a sky of radiance 1.
double expected_beneath(vec3 normal) {
  return 1.0 - std::pow(std::sin(cap_angle), 2) * double(glm::dot(normal, cap_axis));
}

TEST(SharedSamples, PicturesMeetTheClosedFormOverSeeds) {
  const Scene scene = picture(32);
  constexpr int seeds = 48;
  for (const char* backend : {"scalar", "simd"}) {
    std::vector<std::vector<double>> values(scene.receivers.normal.size());
    for (int seed = 0; seed < seeds; ++seed) {
      const std::vector<vec3> image =
          test::shade("ray-traced", backend, {"rays=16", "seed=" + std::to_string(seed), "occluder=spheres"}, scene);
      for (std::size_t i = 0; i < image.size(); ++i) values[i].push_back(double(image[i].x));
    }
    double chi2 = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double z = z_score(values[i], expected_beneath(scene.receivers.normal[i]));
      chi2 += z * z, sum += z;
    }
    EXPECT_NEAR(chi2 / double(values.size()), 1.04, 0.2) << backend;  // Student's t of 47 degrees of freedom: 47 / 45
    EXPECT_LT(std::abs(sum) / std::sqrt(double(values.size())), 4.0) << backend;
  }
}

/// Where the sets of all cones were too large, receivers draw their own.
TEST(SharedSamples, ManyRaysAreDrawnByEachReceiver) {
  const Scene scene = picture(8);
  const Registry registry = cuda_on_host::make_registry();
  std::vector<vec3> images[2];
  for (const char* backend : {"scalar", "simd"}) {
    const auto technique =
        make_technique(registry.find("ray-traced", backend), parse_parameters({"rays=8192", "occluder=spheres"}));
    std::vector<vec3>& image = images[backend[1] == 'i'];
    image = test::shade(*technique, scene);
    EXPECT_LT(technique->footprint().per_frame, std::size_t(64) << 20);
    for (std::size_t i = 0; i < image.size(); ++i)
      EXPECT_NEAR(double(image[i].x), expected_beneath(scene.receivers.normal[i]), 0.01) << i;
  }
  EXPECT_LT(test::difference(images[0], images[1]), 1e-3);
}

}  // namespace
}  // namespace penumbra
