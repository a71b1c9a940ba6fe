#include "techniques/bases/haar.h"

#include "techniques/bases/random.h"
#include "tests/support.h"

namespace penumbra::haar {
namespace {

template <class T>
std::vector<T> random_values(int count, std::uint64_t seed) {
  std::vector<T> v;
  for (int k = 0; k < count; ++k) v.push_back(T(2 * random_triple(seed, std::uint32_t(k)).x - 0.7f));
  return v;
}
template <class T>
std::span<const T> view(const std::vector<T>& v) {
  return v;
}
double pixel_integral(const std::vector<double>& f, const std::vector<double>& g, const std::vector<double>& h) {
  double sum = 0.0;
  for (std::size_t k = 0; k < f.size(); ++k) sum += f[k] * g[k] * h[k];
  return sum / double(f.size());
}

TEST(Haar, IndicesAreABijection) {
  for (int index = 1; index < 4096; ++index) {
    const auto [s, mother] = place_of(index);
    ASSERT_EQ(coefficient_index(s, mother), index);
    ASSERT_LT(s.i, 1 << s.level);
    ASSERT_LT(s.j, 1 << s.level);
  }
}

TEST(Haar, TransformIsOrthonormalAndInvertible) {
  for (const int n : {1, 2, 4, 32}) {
    const auto f = random_values<double>(n * n, 1), g = random_values<double>(n * n, 2);
    const auto cf = transform(view(f)), cg = transform(view(g));
    double pixels = 0.0, products = 0.0;
    for (int k = 0; k < n * n; ++k) pixels += f[k] * g[k] / (n * n), products += cf[k] * cg[k];
    EXPECT_NEAR(pixels, products, 1e-14);
    const auto back = inverse(view(cf));
    for (int k = 0; k < n * n; ++k) EXPECT_NEAR(back[k], f[k], 1e-13);
  }
}

TEST(Haar, MothersHaveThePublishedSigns) {
  const std::vector<double> left = {1, 0, 1, 0}, top = {1, 1, 0, 0}, diagonal = {1, 0, 0, 1};
  EXPECT_EQ(transform(view(left)), (std::vector<double>{0.5, 0.5, 0, 0}));
  EXPECT_EQ(transform(view(top)), (std::vector<double>{0.5, 0, 0.5, 0}));
  EXPECT_EQ(transform(view(diagonal)), (std::vector<double>{0.5, 0, 0, 0.5}));
}

TEST(Haar, PyramidsFromPixelsAndFromCoefficientsAgree) {
  const auto f = random_values<double>(1024, 3);
  const auto a = mean_pyramid(view(f)), b = mean_pyramid_of_coefficients(view(transform(view(f))));
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-14);
}

// Hard case 19: float pyramids at 128 x 128 keep the product although leaves drift.
TEST(Haar, FloatDriftIsBounded) {
  const auto f = random_values<float>(128 * 128, 3);
  const auto a = mean_pyramid(view(f)), b = mean_pyramid_of_coefficients(view(transform(view(f))));
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 2e-6f);
}

TEST(Haar, LinearTimeProductIsThePixelSum) {
  for (const int n : {1, 2, 4, 8, 32}) {
    const auto p = random_values<double>(n * n, 4), l = random_values<double>(n * n, 5),
               v = random_values<double>(n * n, 6);
    const double exact = pixel_integral(p, l, v);
    EXPECT_NEAR(triple_product(view(transform(view(p))), view(transform(view(l))), view(transform(view(v)))), exact,
                1e-15);
  }
}

// Hard case 19 at 128 x 128: at most 1e-6 relative in float, 3e-11 in double.
TEST(Haar, LargeProducts) {
  const int n = 128;
  std::vector<double> p(n * n), l(n * n), v(n * n);
  for (int k = 0; k < n * n; ++k) {
    const RandomTriple r = random_triple(9, std::uint32_t(k));
    p[k] = double(r.x), l[k] = std::exp(6.0 * double(r.y)), v[k] = double(int(r.z * 2));
  }
  const double exact = pixel_integral(p, l, v);
  EXPECT_NEAR(triple_product(view(transform(view(p))), view(transform(view(l))), view(transform(view(v)))) / exact, 1,
              3e-11);
  const auto to_float = [](const std::vector<double>& x) { return std::vector<float>(x.begin(), x.end()); };
  const auto pf = to_float(p), lf = to_float(l), vf = to_float(v);
  EXPECT_NEAR(triple_product(view(transform(view(pf))), view(transform(view(lf))), view(transform(view(vf)))) / exact,
              1, 1e-6);
}

// The tripling theorem, by brute force over pixels: values and exact counts 9nN - 7N + 8 (ordered), 3nN - (8N - 11)/3.
TEST(Haar, TriplingTheoremAndItsCounts) {
  for (int levels = 1; levels <= 2; ++levels) {
    const int size = 1 << (2 * levels);
    std::vector<std::vector<double>> basis;
    for (int k = 0; k < size; ++k) {
      std::vector<double> unit(size, 0.0);
      unit[k] = 1.0;
      basis.push_back(inverse(view(unit)));
    }
    for (int u = 0; u < size; ++u)
      for (int v = 0; v < size; ++v)
        for (int w = 0; w < size; ++w)
          ASSERT_NEAR(tripling_coefficient(u, v, w), pixel_integral(basis[u], basis[v], basis[w]), 1e-13);
  }
  for (int levels = 1; levels <= 3; ++levels) {
    const long size = 1L << (2 * levels);
    long ordered = 0, unordered = 0;
    for (int u = 0; u < size; ++u)
      for (int v = 0; v < size; ++v)
        for (int w = 0; w < size; ++w)
          if (tripling_coefficient(u, v, w) != 0.0) {
            ++ordered;
            unordered += u <= v && v <= w;
          }
    EXPECT_EQ(ordered, 9 * levels * size - 7 * size + 8);
    EXPECT_EQ(unordered, 3 * levels * size - (8 * size - 11) / 3);
  }
}

// Hard case 21: with unit coefficients at l = 3 all six orders return 2^l.
TEST(Haar, AllSixPermutationsCount) {
  const Square s{3, 5, 2};
  int order[3] = {0, 1, 2};
  do {
    std::vector<double> p(1024, 0.0), l(1024, 0.0), v(1024, 0.0);
    p[coefficient_index(s, order[0])] = l[coefficient_index(s, order[1])] = v[coefficient_index(s, order[2])] = 1.0;
    EXPECT_DOUBLE_EQ(triple_product(view(p), view(l), view(v)), 8.0);
  } while (std::next_permutation(order, order + 3));
}

/// The paper numbers blocks with the first pixel as the most significant bit.
unsigned from_paper(unsigned block) {
  unsigned reversed = 0;
  for (int k = 0; k < 16; ++k) reversed |= (block >> k & 1u) << (15 - k);
  return reversed;
}

// The paper's example block 0x7310.
TEST(Haar, PublishedBlock) {
  const auto& row = binary_table()[from_paper(0x7310)];
  EXPECT_EQ(row[0], 6);                                                          // mean 0.375
  EXPECT_EQ(std::vector<int>(row + 1, row + 4), (std::vector<int>{-4, 4, -2}));  // -0.25, 0.25, -0.125
  const int tl = 0, tr = 1, bl = 2, br = 3;
  for (const int q : {tl, br}) {
    EXPECT_EQ(row[4 + q], -2);
    EXPECT_EQ(row[8 + q], 2);
    EXPECT_EQ(row[12 + q], -2);
  }
  for (const int q : {tr, bl})
    for (const int m : {4, 8, 12}) EXPECT_EQ(row[m + q], 0);
}

TEST(Haar, EveryBlockReturnsItsBitsExactly) {
  for (unsigned block = 0; block < 65536; ++block) {
    std::vector<float> c(16);
    for (int k = 0; k < 16; ++k) c[k] = float(binary_table()[block][k]) / 16.0f;
    const auto pixels = inverse(view(c));
    for (int k = 0; k < 16; ++k) ASSERT_EQ(pixels[k], float(block >> k & 1u)) << block;
  }
}

class TwoLevelStores : public testing::TestWithParam<int> {};

TEST_P(TwoLevelStores, EqualTheDenseTransform) {
  const int n = GetParam();
  BitCube blocked(n);
  for (int t = 0; t < 6 * n * n; ++t)
    if (mix_bits(std::uint64_t(t)) % 3 == 0) blocked.set(t);
  TwoLevel store;
  transform_visibility(blocked, store);
  for (int face = 0; face < 6; ++face) {
    std::vector<float> open;
    for (int k = 0; k < n * n; ++k) open.push_back(blocked.test(face * n * n + k) ? 0.0f : 1.0f);
    EXPECT_EQ(coefficients(store, face), transform(view(open))) << "dyadic values: no rounding at all";
  }
}

// Hard case 14: nothing blocked and everything blocked.
TEST_P(TwoLevelStores, UniformVisibilityHasNoWavelets) {
  for (const bool all : {false, true}) {
    BitCube blocked(GetParam());
    blocked.fill(all);
    TwoLevel store;
    transform_visibility(blocked, store);
    for (int face = 0; face < 6; ++face) {
      const auto c = coefficients(store, face);
      EXPECT_EQ(c[0], all ? 0.0f : 1.0f);
      for (std::size_t k = 1; k < c.size(); ++k) ASSERT_EQ(c[k], 0.0f);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, TwoLevelStores, testing::Values(16, 32, 64));

// Hard case 16: one bright texel has exactly 16 coefficients on its face.
TEST(Haar, SunTexelHasSixteenCoefficients) {
  std::vector<double> face(1024, 0.0);
  face[13 * 32 + 22] = 1e6;
  const auto c = transform(view(face));
  EXPECT_EQ(std::count_if(c.begin(), c.end(), [](double v) { return v != 0.0; }), 16);
}

// Hard case 18: one NaN spoils 16 coefficients and every leaf, so lights are sanitised before.
TEST(Haar, NanSpreads) {
  std::vector<double> face(1024, 1.0);
  face[13 * 32 + 22] = NAN;
  const auto c = transform(view(face));
  EXPECT_EQ(std::count_if(c.begin(), c.end(), [](double v) { return std::isnan(v); }), 16);
  const auto leaves = inverse(view(c));
  EXPECT_EQ(std::count_if(leaves.begin(), leaves.end(), [](double v) { return std::isnan(v); }), 1024);
}

// Hard case 17: a blocked sun leaves a residue in the wavelet basis, large in float, negligible in double.
TEST(Haar, BlockedSunLeavesAResidue) {
  const auto residue = [](auto sun) {
    using T = decltype(sun);
    std::vector<T> light(1024, T(1)), v(1024, T(1)), p(1024, T(1));
    light[13 * 32 + 22] = sun;
    v[13 * 32 + 22] = T(0);
    const T product = triple_product(view(transform(view(p))), view(transform(view(light))), view(transform(view(v))));
    return std::abs(double(product) - 1023.0 / 1024.0);
  };
  EXPECT_LT(residue(1e6f), 1e-2);
  EXPECT_LT(residue(1e6), 1e-9);
}

}  // namespace
}  // namespace penumbra::haar
