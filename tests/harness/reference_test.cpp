#include "harness/measure/reference.h"

#include <tbb/task_arena.h>

#include <random>

#include "harness/measure/parity.h"
#include "scenes/error.h"
#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Reference compute(const Scene& scene, Rung rung, ReferenceSettings settings = {}) {
  Animation animation(scene);
  return compute_reference(animation.frame(0), rung, settings);
}

/// Receivers beside a sphere of radius 1/2 that rests on the plane.
Scene resting_sphere() {
  std::vector<vec3> positions;
  for (int i = 0; i < 64; ++i) positions.emplace_back(0.1f + 0.05f * float(i), 0, 0);
  Scene scene = test::sphere_scene({{{0, 0.5f, 0}, 0.5f}}, test::receivers_at(positions));
  scene.mesh = make_sphere({0, 0.5f, 0}, 0.5f, 512);
  return scene;
}

TEST(Reference, TruthMeetsTheClosedFormWithinItsOwnError) {
  const Scene scene = resting_sphere();
  const Reference truth = compute(scene, Rung::truth);
  double chi2 = 0.0;
  for (int i = 0; i < 64; ++i) {
    const double x = scene.receivers.position[i].x / 0.5, exact = 1 - std::pow(1 + x * x, -1.5);
    const double sigma = std::sqrt(double(truth.variance.pixels[i].x));
    EXPECT_NEAR(truth.mean.pixels[i].x, exact, 5 * sigma + 1e-3) << i;  // 1e-3: the sphere is a mesh
    chi2 += std::pow((double(truth.mean.pixels[i].x) - exact) / std::max(sigma, 3e-4), 2);
    EXPECT_NEAR(truth.unshadowed.pixels[i].x, 1.0, 5e-3);
  }
  EXPECT_LT(chi2 / 64, 3.0) << "the stated variance is too small";
  EXPECT_GT(chi2 / 64, 0.05) << "the stated variance is too large";
  EXPECT_LE(truth.noise(std::vector<bool>(64, true)), 0.002);
}

/// Receivers of many normals beside a sphere that all of them see whole: each gets 1 - sin^2(theta) (N . v) of a sky of
/// radiance 1, v towards the sphere, which has the half angle theta. Most face it, a few look past it.
Scene picture_beside_a_sphere(int edge) {
  std::mt19937 random(5);
  std::normal_distribution<float> along;
  Scene scene = test::sphere_scene({{{0, 2, 0}, 1.2f}}, {});
  scene.mesh = make_sphere({0, 2, 0}, 1.2f, 256);
  std::vector<vec3> positions, normals;
  while (int(positions.size()) < edge * edge) {
    const vec3 position(1.5f * along(random), 0.0f, 1.5f * along(random)), to = vec3(0, 2, 0) - position;
    const vec3 normal = glm::normalize(vec3(along(random), 2.0f + along(random), along(random)));
    const float sine = 1.2f / glm::length(to);
    if (glm::dot(normal, glm::normalize(to)) <= sine) continue;  // partly below the horizon
    positions.push_back(position), normals.push_back(normal);
  }
  scene.receivers = test::receivers_at(positions);
  scene.receivers.normal = normals;
  scene.receivers.width = scene.receivers.height = edge;
  return scene;
}

/// The squares of the errors are what the variances say, over the picture, over its darker and its lighter half.
TEST(Reference, TheTruthOfAPictureErrsAsItsVarianceSays) {
  const Scene scene = picture_beside_a_sphere(64);
  const Reference truth = compute(scene, Rung::truth, {32, 0.003, 1 << 16});
  double squares[2] = {}, variances[2] = {}, sum = 0.0;
  for (int i = 0; i < scene.receivers.size(); ++i) {
    const dvec3 to = dvec3(0, 2, 0) - dvec3(scene.receivers.position[i]);
    const double exact = 1.0 - 1.44 / glm::dot(to, to) * glm::dot(dvec3(scene.receivers.normal[i]), glm::normalize(to));
    const double error = double(truth.mean.pixels[i].x) - exact, variance = double(truth.variance.pixels[i].x);
    const int half = exact > 0.85;
    squares[half] += error * error, variances[half] += variance, sum += error;
  }
  for (const int half : {0, 1}) EXPECT_NEAR(squares[half] / variances[half], 1.0, 0.15) << half;
  EXPECT_LT(std::abs(sum), 8.0 * std::sqrt(variances[0] + variances[1])) << "neighbours share sets: more than 4";
  EXPECT_LE(truth.noise(std::vector<bool>(4096, true)), 0.003);
}

TEST(Reference, TruthOfADiscLightMeetsTheClosedForm) {
  Scene scene = test::sphere_scene({{{0, -50, 0}, 1.0f}}, test::receivers_at({vec3(0.0f)}));
  scene.light = make_disc({0, 2, 0}, {0, -1, 0}, 1.0f, vec3(1.0f));
  EXPECT_NEAR(compute(scene, Rung::truth).mean.pixels[0].x, 0.2, 1e-3);
  EXPECT_NEAR(compute(scene, Rung::r13x13).mean.pixels[0].x, 0.2, 2e-3);
}

TEST(Reference, CubeIsPixelBasisWithRays) {
  const Scene scene = thinned(load_scene("torus-knot-sunset"), 16);
  const Reference cube = compute(scene, Rung::cube);
  for (const char* backend : {"scalar", "simd"})
    EXPECT_LT(test::difference(test::shade("pixel-basis", backend, {"visibility=rays"}, scene), cube.mean.pixels),
              1e-6);
}

TEST(Reference, SpheresIsPixelBasisWithExactCaps) {
  const Scene scene = thinned(load_scene("bunny-city-camera"), 16);
  for (const int n : {16, 32, 64}) {
    ReferenceSettings settings;
    settings.resolution = n;
    const Reference spheres = compute(scene, Rung::spheres, settings);
    for (const char* backend : {"scalar", "simd"})
      EXPECT_LT(test::difference(test::shade("pixel-basis", backend,
                                             {"visibility=raster", "resolution=" + std::to_string(n)}, scene),
                                 spheres.mean.pixels),
                1e-6)
          << n;
  }
}

// Hard case 34: values k / 169; an edge aligned with the light's sides gives k / 13.
TEST(Reference, ThirteenByThirteen) {
  Scene scene = test::sphere_scene({{{0, -50, 0}, 1.0f}}, {});
  std::vector<vec3> positions;
  for (int i = 0; i < 40; ++i) positions.emplace_back(-1.0f + 0.05f * float(i), 0, 0);
  scene.receivers = test::receivers_at(positions);
  scene.light = make_rectangle({0, 2, 0}, {1, 0, 0}, {0, 0, 1}, vec3(1.0f));
  scene.mesh = make_box({0, 0.99f, -50}, {100, 1.01f, 50});
  Animation animation(scene);
  const Frame frame = animation.frame(0);
  bool partial = false;
  for (int i = 0; i < 40; ++i) {
    const float v = visibility_13x13(frame, i) * 13;
    EXPECT_NEAR(v, std::round(v), 1e-4f);
    partial |= v > 0.5f && v < 12.5f;
  }
  EXPECT_TRUE(partial);
  scene.mesh = make_sphere({0.1f, 1, 0.2f}, 0.3f);
  Animation round(scene);
  for (int i = 0; i < 40; ++i) {
    const float v = visibility_13x13(round.frame(0), i) * 169;
    EXPECT_NEAR(v, std::round(v), 1e-3f);
  }
}

/// A lamp of 1 x 1 at y = 2 over a half-plane at y = 1 that covers what lies beyond the edge 0 along an axis. From a
/// receiver at r along it the edge hides what lies beyond -r of the lamp.
Scene half_covered(int axis, bool beyond, const std::vector<float>& along) {
  std::vector<vec3> positions(along.size(), vec3(0.0f));
  for (std::size_t i = 0; i < along.size(); ++i) positions[i][axis] = along[i];
  Scene scene = test::sphere_scene({}, test::receivers_at(positions));
  scene.light = make_rectangle({0, 2, 0}, {1, 0, 0}, {0, 0, 1}, vec3(3.0f));
  vec3 low(-50, 1, -50), high(50, 1.0001f, 50);
  (beyond ? low : high)[axis] = 0.0f;
  scene.mesh = make_box(low, high);
  return scene;
}

/// Receivers a quarter of a cell to either side of where a centre comes into sight: edges of cells would give another
/// number at half of them. Columns and rows, both sides: the count of centres, and the same mirrored.
TEST(Reference, ThirteenByThirteenLooksAtTheCentresOfCells) {
  std::vector<float> along;
  for (int k = -7; k <= 7; ++k)
    for (const float quarter : {-0.25f, 0.25f}) along.push_back((float(k) + quarter) / 13.0f);
  for (const int axis : {0, 2})
    for (const bool beyond : {false, true}) {
      const Scene scene = half_covered(axis, beyond, along);
      Animation animation(scene);
      const Frame frame = animation.frame(0);
      const Reference rung = compute_reference(frame, Rung::r13x13, {});
      for (std::size_t i = 0; i < along.size(); ++i) {
        int open = 0;
        double arrives = 0.0;
        for (int cell = 0; cell < 13; ++cell) {
          const double at = (cell + 0.5) / 13.0 - 0.5;
          if (beyond ? at > -double(along[i]) : at < -double(along[i])) continue;
          ++open;
          for (int other = 0; other < 13; ++other) {
            const double across = (other + 0.5) / 13.0 - 0.5, beside = at - double(along[i]);
            arrives += 3.0 * 4.0 / (pi * std::pow(4.0 + beside * beside + across * across, 2)) / 169.0;
          }
        }
        EXPECT_NEAR(visibility_13x13(frame, int(i)) * 13.0f, float(open), 1e-4f) << axis << beyond << " " << along[i];
        EXPECT_NEAR(double(rung.mean.pixels[i].x), arrives, 1e-5) << axis << beyond << " " << along[i];
        EXPECT_NEAR(rung.mean.pixels[i].x, rung.mean.pixels[i].z, 1e-7f);
      }
    }
}

TEST(Reference, InapplicableRungsSayWhy) {
  Scene scene = resting_sphere();
  EXPECT_THROW(compute(scene, Rung::r13x13), Unsupported);
  scene.spheres = {};
  EXPECT_THROW(compute(scene, Rung::spheres), Unsupported);
  scene.light = make_disc({0, 2, 0}, {0, -1, 0}, 1.0f, vec3(1.0f));
  EXPECT_THROW(compute(scene, Rung::cube), Unsupported);
  EXPECT_NE(test::error_of([] { parse_rung("thruth"); }).find("truth, 13x13"), std::string::npos);
}

TEST(Reference, ThreadsDoNotChangeABit) {
  const Scene scene = resting_sphere();
  Reference one, two;
  tbb::task_arena(1).execute([&] { one = compute(scene, Rung::truth); });
  tbb::task_arena(2).execute([&] { two = compute(scene, Rung::truth); });
  EXPECT_EQ(one.mean.pixels, two.mean.pixels);
  EXPECT_EQ(one.variance.pixels, two.variance.pixels);
}

TEST(Reference, NoiseThatIsNotReachedIsSaidWhetherComputedOrLoaded) {
  const test::TemporaryFolder folder;
  setenv("PENUMBRA_CACHE", folder.path().c_str(), 1);
  const Scene scene = resting_sphere();
  Animation animation(scene);
  const Frame frame = animation.frame(0);
  const auto said = [&](double noise) {
    return test::messages_of([&] { cached_reference(frame, Rung::truth, {32, noise, 2048}); });
  };
  for (const char* from : {"computed", "loaded"}) {
    EXPECT_NE(said(1e-4).find("0.01 % was asked for"), std::string::npos) << from;
    EXPECT_NE(said(1e-4).find("--noise"), std::string::npos) << from;
    EXPECT_EQ(said(0.05), "") << from;
  }
  unsetenv("PENUMBRA_CACHE");
}

class ReferenceCache : public testing::Test {
 protected:
  ReferenceCache() { setenv("PENUMBRA_CACHE", folder_.path().c_str(), 1); }
  ~ReferenceCache() override { unsetenv("PENUMBRA_CACHE"); }

  Reference get() {
    Animation animation(scene_);
    return cached_reference(animation.frame(0), Rung::truth, settings_);
  }
  std::string file() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) return entry.path();
    return "";
  }

  test::TemporaryFolder folder_;
  Scene scene_ = resting_sphere();
  ReferenceSettings settings_{32, 0.05, 1024};
};

TEST_F(ReferenceCache, SecondTimeComesFromDisk) {
  const Reference first = get(), second = get();
  EXPECT_FALSE(first.from_cache);
  EXPECT_TRUE(second.from_cache);
  EXPECT_EQ(first.mean.pixels, second.mean.pixels);
  EXPECT_EQ(first.variance.pixels, second.variance.pixels);
  EXPECT_EQ(first.unshadowed.pixels, second.unshadowed.pixels);
  EXPECT_EQ(first.rays_per_receiver, second.rays_per_receiver);
}

TEST_F(ReferenceCache, TruncatedAndForeignFilesAreRebuilt) {
  const Reference good = get();
  const std::string path = file(), bytes = test::read_text(path);
  std::ofstream(path, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  Reference again = get();
  EXPECT_FALSE(again.from_cache);
  EXPECT_EQ(again.mean.pixels, good.mean.pixels);
  std::ofstream(path, std::ios::binary) << "something else";
  EXPECT_FALSE(get().from_cache);
  ChannelImage other = load_channels(path);
  other.values[5] += 1.0f;  // whole, but not what was written
  save_channels(path, other);
  EXPECT_FALSE(get().from_cache);
  EXPECT_TRUE(get().from_cache);
}

TEST_F(ReferenceCache, KeyFollowsWhatTheRungDependsOn) {
  Animation animation(scene_);
  const Frame frame = animation.frame(0);
  const auto key = [&](Rung rung) { return reference_key(frame, rung, settings_); };
  const std::string truth = key(Rung::truth), cube = key(Rung::cube), spheres = key(Rung::spheres);
  EXPECT_NE(truth, cube);
  EXPECT_NE(cube, spheres);
  settings_.resolution = 16;
  EXPECT_EQ(key(Rung::truth), truth);
  EXPECT_NE(key(Rung::cube), cube);
  settings_.resolution = 32;
  scene_.spheres.spheres[0].radius = 0.4f;
  Animation moved(scene_);
  EXPECT_EQ(reference_key(moved.frame(0), Rung::truth, settings_), truth);
  EXPECT_NE(reference_key(moved.frame(0), Rung::spheres, settings_), spheres);
  std::get<Environment>(scene_.light).rotation = 0.1;
  Animation turned(scene_);
  EXPECT_NE(reference_key(turned.frame(0), Rung::truth, settings_), truth);
}

TEST_F(ReferenceCache, UnwritableFolderIsOnlyAWarning) {
  setenv("PENUMBRA_CACHE", "/proc/nowhere", 1);
  EXPECT_FALSE(get().from_cache);
}

}  // namespace
}  // namespace penumbra
