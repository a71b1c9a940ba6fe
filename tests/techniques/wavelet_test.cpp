#include "harness/measure/parity.h"
#include "scenes/scene_file.h"
#include "techniques/bases/random.h"
#include "techniques/wavelet/sparse_product.h"
#include "tests/support.h"

namespace penumbra::wavelet {
namespace {

constexpr int n = 16;

Function random_function(std::uint64_t seed) {
  std::vector<double> texels;
  for (std::uint32_t t = 0; t < 6 * n * n; ++t) texels.push_back(double(random_triple(seed, t).x));
  return Function(n, texels);
}

BitCube random_bits(std::uint64_t seed) {
  BitCube blocked(n);
  for (int t = 0; t < 6 * n * n; ++t)
    if (mix_bits(seed + std::uint64_t(t)) % 4 == 0) blocked.set(t);
  return blocked;
}

/// Sum over pixels of p L V / N: what all terms together give.
double pixel_sum(const Function& p, const Function& light, const BitCube& blocked) {
  double sum = 0.0;
  for (int face = 0; face < 6; ++face) {
    const auto leaves = [&](const Function& f) {
      return haar::inverse(std::span<const float>(f.coefficients).subspan(std::size_t(face) * n * n, n * n));
    };
    const auto pp = leaves(p), ll = leaves(light);
    for (int k = 0; k < n * n; ++k)
      if (!blocked.test(face * n * n + k)) sum += double(pp[k]) * double(ll[k]) / (n * n);
  }
  return sum;
}

/// Value of a functional, the slow way: on the coefficients of V one by one.
double apply(const Functional& f, int channel, const Visibility& v) {
  double sum = 0.0;
  for (std::size_t k = 0; k < f.level1[channel].size(); ++k)
    sum += double(f.level1[channel][k]) * double(v.store.level1[k]);
  for (std::size_t block = 0; block < f.slot.size(); ++block)
    for (int k = 0; f.slot[block] >= 0 && k < 16; ++k)
      sum += double(f.level2[std::size_t(f.slot[block] * f.channels) * 16 + std::size_t(channel) * 16 + k]) *
             double(haar::binary_table()[v.store.blocks[block]][k]);
  return sum;
}

TEST(SparseProduct, AllTermsOnBothLevelsAreThePixelSum) {
  const Function p = random_function(1), light = random_function(2);
  const auto all_p = keep_largest(p, 6 * n * n, 1.0), all_light = keep_largest(light, 6 * n * n, 1.0);
  EXPECT_EQ(all_p.size(), std::size_t(6 * (n * n - 1))) << "every wavelet, no scale";
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const BitCube blocked = random_bits(seed);
    Visibility v;
    v.assign(blocked);
    Evaluate sink(v);
    triple_product(p, light, all_p, all_light, {2, 2}, sink);
    EXPECT_NEAR(sink.sum(), pixel_sum(p, light, blocked), 2e-6);
  }
}

TEST(SparseProduct, TheFunctionalIsTheLoops) {
  const Function p = random_function(3), light = random_function(4);
  for (const int terms : {1, 50, 500, 6 * n * n})
    for (const Levels levels : {Levels{1, 1}, Levels{2, 1}, Levels{2, 2}}) {
      const auto kept_p = keep_largest(p, terms, 1.0), kept_light = keep_largest(light, terms, 0.5);
      Collect collect(n);
      collect.set_channel(1);
      triple_product(p, light, kept_p, kept_light, levels, collect);
      const Functional f = collect.take();
      Visibility v;
      v.assign(random_bits(std::uint64_t(terms)));
      Evaluate sink(v);
      triple_product(p, light, kept_p, kept_light, levels, sink);
      // Table entries are of blocked pixels; V's sign is in the weights.
      EXPECT_NEAR(apply(f, 1, v), sink.sum(), 1e-5) << terms << " " << levels.light << levels.p;
      EXPECT_EQ(apply(f, 0, v), 0.0) << "other channels stay empty";
    }
}

TEST(SparseProduct, LevelOneNeverLooksBelowTheBlocks) {
  struct Watch {
    void coefficient(int, int index, float) { deepest = std::max(deepest, index); }
    void mean(int, haar::Square s, float) { finest = std::max(finest, s.level); }
    int deepest = 0, finest = 0;
  } watch;
  const Function p = random_function(5), light = random_function(6);
  triple_product(p, light, keep_largest(p, 2000, 0.0), keep_largest(light, 2000, 0.0), {1, 1}, watch);
  EXPECT_LT(watch.deepest, n * n / 16);
  EXPECT_EQ(watch.finest, haar::levels_of(n) - 2);
}

TEST(SparseProduct, KeepsTheLargest) {
  const Function f = random_function(7);
  const auto plain = keep_largest(f, 100, 0.0);
  ASSERT_EQ(plain.size(), 100u);
  for (std::size_t k = 1; k < plain.size(); ++k)
    EXPECT_GE(std::abs(f.at(plain[k - 1].face, plain[k - 1].index)), std::abs(f.at(plain[k].face, plain[k].index)));
  double level_sum[2] = {0, 0};
  for (const Term& t : plain) level_sum[0] += haar::place_of(t.index).square.level;
  for (const Term& t : keep_largest(f, 100, 2.0)) level_sum[1] += haar::place_of(t.index).square.level;
  EXPECT_LE(level_sum[1], level_sum[0]) << "gamma prefers coarse wavelets";
}

/// A wavelet of each level, made by hand so that every gamma ranks them otherwise: 1, 3, 5, 9 from coarse to fine.
Function one_of_each_level() {
  Function f(n, std::vector<double>(6 * n * n, 0.0));
  for (const auto& [index, value] : {std::pair(1, 1.0f), {5, -3.0f}, {17, 5.0f}, {65, -9.0f}})
    f.coefficients[std::size_t(2 * n * n + index)] = value;
  return f;
}

std::vector<int> levels_of(const std::vector<Term>& terms) {
  std::vector<int> levels;
  for (const Term& t : terms) levels.push_back(haar::place_of(t.index).square.level);
  return levels;
}

TEST(SparseProduct, GammaIsTheExponentOfTheRanking) {
  const Function f = one_of_each_level();
  EXPECT_EQ(levels_of(keep_largest(f, 4, 0.0)), (std::vector<int>{3, 2, 1, 0})) << "9 5 3 1";
  EXPECT_EQ(levels_of(keep_largest(f, 4, 0.5)), (std::vector<int>{3, 2, 1, 0})) << "3.2 2.5 2.1 1";
  EXPECT_EQ(levels_of(keep_largest(f, 4, 1.0)), (std::vector<int>{1, 2, 3, 0})) << "1.5 1.25 1.125 1";
  EXPECT_EQ(levels_of(keep_largest(f, 4, 1.5)), (std::vector<int>{1, 0, 2, 3})) << "1.06 1 0.6 0.4";
  EXPECT_EQ(levels_of(keep_largest(f, 4, 2.0)), (std::vector<int>{0, 1, 2, 3})) << "1 0.75 0.3 0.14";
}

TEST(SparseProduct, EqualTermsGoByTheirPlace) {
  Function f(n, std::vector<double>(6 * n * n, 0.0));
  for (const int at : {3 * n * n + 2, n * n + 7, n * n + 5}) f.coefficients[std::size_t(at)] = at % 2 ? 2.0f : -2.0f;
  const auto kept = keep_largest(f, 3, 0.0);
  EXPECT_EQ((std::array{kept[0].face, kept[1].face, kept[2].face}), (std::array{1, 1, 3}));
  EXPECT_EQ((std::array{kept[0].index, kept[1].index, kept[2].index}), (std::array{5, 7, 2}));
}

TEST(SparseProduct, EffectIsTheSizeTimesThatOfThePartnersUnderTheLight) {
  const Function p = one_of_each_level();
  std::vector<Function> light(1, Function(n, std::vector<double>(6 * n * n, 1.0)));
  EXPECT_EQ(levels_of(keep_largest_effect(p, light, 4)), (std::vector<int>{1, 2, 3, 0})) << "its mean, 2^-level";
  // A wavelet of the light on the square of the second: 5 (1/4 + 1/2); its mother is another.
  const auto [square, mother] = haar::place_of(17);
  light[0].coefficients[std::size_t(2 * n * n + haar::coefficient_index(square, (mother + 1) % 3))] = -0.5f;
  EXPECT_EQ(levels_of(keep_largest_effect(p, light, 4)), (std::vector<int>{2, 1, 3, 0}));
  light.push_back(Function(n, std::vector<double>(6 * n * n, 0.0)));  // another channel: a wavelet over the first
  light[1].coefficients[std::size_t(2 * n * n + 1)] = 3.0f;
  EXPECT_EQ(levels_of(keep_largest_effect(p, light, 4)), (std::vector<int>{0, 2, 1, 3})) << "channels add up";
}

class WaveletScenes : public testing::Test {
 protected:
  static const Scene& scene() {
    static const Scene instance = thinned(load_scene("torus-knot-studio"), 24);
    return instance;
  }
  static std::vector<vec3> shade(const std::string& name, std::vector<std::string> parameters) {
    parameters.push_back("visibility=raster");
    return test::shade(name, "simd", parameters, scene());
  }
};

TEST_F(WaveletScenes, DenseEqualsPixelBasis) {
  const auto exact = shade("pixel-basis", {});
  EXPECT_LT(test::difference(shade("wavelet-dense", {}), exact), 1e-5);
  Scene thin = thinned(scene(), 6);
  for (const char* visibility : {"visibility=table", "visibility=rays"})
    EXPECT_LT(test::difference(test::shade("wavelet-dense", "scalar", {visibility}, thin),
                               test::shade("pixel-basis", "scalar", {visibility}, thin)),
              1e-5);
  EXPECT_LT(test::difference(shade("wavelet-product", {"terms=6144"}), exact), 1e-5);
}

// Not asserted: that error falls with every further term. It does not; truncation breaks cancellations.
TEST_F(WaveletScenes, ManyTermsAreNearerThanFew) {
  const auto exact = shade("pixel-basis", {});
  EXPECT_LT(test::difference(shade("wavelet-product", {"terms=500"}), exact),
            test::difference(shade("wavelet-product", {"terms=5"}), exact));
}

TEST_F(WaveletScenes, TheProductNeedsFewerTermsThanTheTriple) {
  const auto exact = shade("pixel-basis", {});
  EXPECT_LT(test::difference(shade("wavelet-product", {"terms=200"}), exact), 0.006);
  EXPECT_LT(test::difference(shade("wavelet", {"terms=200", "p_ranking=effect"}), exact), 0.02);
}

// Hard case 22: an axis lies on texel corners of the 6 x 8 x 8 table, so its nearest entry is 10 degrees off.
TEST_F(WaveletScenes, TableNormalsAreTenDegreesOff) {
  const vec3 entry = cube_texel_direction(cube_texel({0, 1, 0}, 8), 8);
  EXPECT_NEAR(std::acos(entry.y) * 180 / pi, 10.02, 0.01);
  EXPECT_GT(test::difference(shade("wavelet", {"normals=table"}), shade("wavelet", {"normals=exact"})), 0.01);
}

TEST_F(WaveletScenes, TableNormalsAreTheNearestOfEightByEight) {
  Scene tilted = thinned(scene(), 8);
  for (int i = 0; i < tilted.receivers.size(); ++i)
    tilted.receivers.normal[i] =
        glm::normalize(vec3(0.2f * float(i % 6) - 0.6f, 1.0f, 0.1f));  // few: plans of their own
  const auto table = test::shade("wavelet", "scalar", {"normals=table", "visibility=raster"}, tilted);
  for (vec3& normal : tilted.receivers.normal) normal = cube_texel_direction(cube_texel(normal, 8), 8);
  EXPECT_EQ(table, test::shade("wavelet", "scalar", {"normals=exact", "visibility=raster"}, tilted));
}

/// The scene with a normal of its own for every receiver.
Scene with_normals(Scene scene) {
  for (int i = 0; i < scene.receivers.size(); ++i) {
    const RandomTriple r = random_triple(5, std::uint32_t(i));
    scene.receivers.normal[i] = glm::normalize(vec3(2 * r.x - 1, 1.5f * r.y - 0.3f, 2 * r.z - 1));
  }
  return scene;
}

TEST_F(WaveletScenes, AllTermsAreThePixelSumForAnyNormal) {
  const Scene all = with_normals(scene());
  for (const char* visibility : {"visibility=raster", "visibility=fine"}) {
    const auto exact = test::shade("pixel-basis", "scalar", {visibility}, all);
    EXPECT_LT(test::difference(test::shade("wavelet-dense", "simd", {visibility}, all), exact), 1e-5);
    EXPECT_LT(test::difference(test::shade("wavelet-product", "simd", {visibility, "terms=6144"}, all), exact), 1e-5);
    EXPECT_LT(test::difference(test::shade("wavelet", "simd", {visibility, "terms=6144"}, all), exact), 1e-5);
  }
}

TEST_F(WaveletScenes, FewTermsDoForAnyNormal) {
  const Scene all = with_normals(scene());
  const auto exact = test::shade("pixel-basis", "simd", {"visibility=raster"}, all);
  for (const char* name : {"wavelet", "wavelet-product"}) {
    EXPECT_LT(test::difference(test::shade(name, "simd", {"visibility=raster"}, all), exact), 0.01) << name;
    EXPECT_GT(test::difference(test::shade(name, "simd", {"visibility=raster", "normals=table"}, all), exact), 0.02);
  }
}

TEST_F(WaveletScenes, NonsenseIsRefused) {
  const auto message = [](const std::string& name, const std::string& parameter) {
    return test::error_of([&] { shade(name, {parameter}); });
  };
  EXPECT_NE(message("wavelet", "terms=0").find("[1, "), std::string::npos);
  EXPECT_NE(message("wavelet", "terms=7000").find("resolution 32 has only 6144"), std::string::npos);
  EXPECT_NE(message("wavelet", "level=3").find("2, 1"), std::string::npos);
  EXPECT_NE(message("wavelet", "resolution=20").find("32, 16, 64"), std::string::npos);
  EXPECT_NE(message("wavelet-dense", "terms=5").find("no parameter 'terms'"), std::string::npos);
  EXPECT_NE(message("wavelet", "ranking=-1").find("[0, 4]"), std::string::npos);
}

}  // namespace
}  // namespace penumbra::wavelet
