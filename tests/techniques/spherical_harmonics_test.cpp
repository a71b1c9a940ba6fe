// The basis against closed forms, and everything fast against the oracle.
#include "techniques/bases/instruction_set.h"
#include "techniques/bases/random.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/kernel.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/projection.h"
#include "techniques/bases/spherical_harmonics/rotation.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"
#include "techniques/bases/spherical_harmonics/tensor.h"
#include "tests/support.h"

#include <fmt/format.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <glm/gtc/matrix_transform.hpp>

namespace penumbra {
namespace {

dvec3 direction(std::uint32_t k) {
  const RandomTriple r = random_triple(7, k);
  const double z = 2.0 * double(r.x) - 1.0, phi = 2.0 * pi * double(r.y), s = std::sqrt(1.0 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}

std::vector<double> random_coefficients(int order, std::uint32_t seed) {
  std::vector<double> c;
  for (int i = 0; i < sh::coefficients(order); ++i)
    c.push_back(2.0 * double(random_triple(seed, std::uint32_t(i)).x) - 1.0);
  return c;
}

std::vector<float> floats(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

glm::dmat3 turn(double angle, dvec3 axis) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, axis));
}

TEST(SphericalHarmonics, FirstBandsAreTheTextbooks) {
  for (std::uint32_t k = 0; k < 20; ++k) {
    const dvec3 w = direction(k);
    const std::vector<double> y = sh::evaluate(3, w);
    const double c1 = std::sqrt(3.0 / (4.0 * pi)), c2 = std::sqrt(15.0 / (4.0 * pi));
    const std::vector<double> expected = {std::sqrt(1.0 / (4.0 * pi)),
                                          -c1 * w.y,
                                          c1 * w.z,
                                          -c1 * w.x,
                                          c2 * w.x * w.y,
                                          -c2 * w.y * w.z,
                                          std::sqrt(5.0 / (16.0 * pi)) * (3.0 * w.z * w.z - 1.0),
                                          -c2 * w.x * w.z,
                                          0.5 * c2 * (w.x * w.x - w.y * w.y)};
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(y[i], expected[i], 1e-14) << i;
  }
}

TEST(SphericalHarmonics, BasisIsOrthonormalUpToOrderTen) {
  const sh::Quadrature q = sh::quadrature(18);
  std::vector<double> gram(100 * 100, 0.0);
  for (std::size_t p = 0; p < q.weight.size(); ++p) {
    const std::vector<double> y = sh::evaluate(10, q.direction[p]);
    for (int i = 0; i < 100; ++i)
      for (int j = 0; j < 100; ++j) gram[i * 100 + j] += q.weight[p] * y[i] * y[j];
  }
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) ASSERT_NEAR(gram[i * 100 + j], i == j ? 1.0 : 0.0, 1e-12) << i << " " << j;
}

TEST(SphericalHarmonics, AdditionTheorem) {
  for (std::uint32_t k = 0; k < 20; ++k) {
    const dvec3 a = direction(k), b = direction(k + 100);
    const std::vector<double> ya = sh::evaluate(10, a), yb = sh::evaluate(10, b);
    for (int l = 0; l < 10; ++l) {
      double sum = 0.0;
      for (int m = -l; m <= l; ++m) sum += ya[sh::index(l, m)] * yb[sh::index(l, m)];
      EXPECT_NEAR(sum, (2 * l + 1) / (4 * pi) * sh::legendre(l, glm::dot(a, b)), 1e-12);
    }
  }
}

TEST(SphericalHarmonics, StraightLineEvaluationEqualsTheOracle) {
  for (int order = 1; order <= sh::max_order; ++order)
    for (std::uint32_t k = 0; k < 50; ++k) {
      const dvec3 w = k == 0 ? dvec3(0, 0, 1) : k == 1 ? dvec3(0, 0, -1) : direction(k);
      const std::vector<double> oracle = sh::evaluate(order, w);
      double fast[100];
      float single[100];
      sh::with_order<1, 10>(order, [&](auto n) {
        sh::evaluate<n>(w, fast);
        sh::evaluate<n>(vec3(w), single);
      });
      for (int i = 0; i < sh::coefficients(order); ++i) {
        ASSERT_NEAR(fast[i], oracle[i], 1e-12) << order << " " << i;
        ASSERT_NEAR(double(single[i]), oracle[i], 2e-5) << order << " " << i;
      }
    }
}

TEST(SphericalHarmonics, OrdersOutsideTheRangeAreRefused) {
  for (const int order : {0, 11, -1}) {
    const std::string expected = fmt::format("order (number of bands) is {}, must be 1 to 10", order);
    EXPECT_NE(test::error_of([&] { sh::evaluate(order, {0, 0, 1}); }).find(expected), std::string::npos);
    EXPECT_NE(test::error_of([&] { sh::tensor(order); }).find(expected), std::string::npos);
    EXPECT_NE(test::error_of([&] { sh::cosine_lobe(order); }).find(expected), std::string::npos);
    EXPECT_NE(test::error_of([&] { sh::Rotation(order, glm::dmat3(1.0)); }).find(expected), std::string::npos);
    EXPECT_NE(test::error_of([&] { sh::project_samples(order, {}, [](dvec3) { return 0.0; }); }).find(expected),
              std::string::npos);
    EXPECT_NE(test::error_of([&] { sh::evaluate_batch(order, nullptr, 0, nullptr); }).find(expected),
              std::string::npos);
  }
  EXPECT_NE(test::error_of([&] { sh::product(7, nullptr, nullptr, nullptr); }).find("is 7, must be 2 to 6"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              sh::reconstruct(std::vector<double>(5), {0, 0, 1});
            }).find("5 coefficients"),
            std::string::npos);
}

TEST(SphericalHarmonics, TensorHasThePublishedNumbersOfEntries) {
  const std::size_t all[] = {83, 353, 1158, 2907}, distinct[] = {25, 77, 238, 549};
  for (int order = 3; order <= 6; ++order) {
    EXPECT_EQ(sh::tensor(order).entries().size(), all[order - 3]);
    EXPECT_EQ(sh::tensor(order).distinct().size(), distinct[order - 3]);
  }
}

/// The product is the projection of the pointwise product: an integral that the quadrature has exactly.
TEST(SphericalHarmonics, ProductIsTheProjectedPointwiseProduct) {
  for (int order = 2; order <= 6; ++order) {
    const auto f = random_coefficients(order, 1), g = random_coefficients(order, 2);
    const std::vector<double> product = sh::tensor(order).product(f, g);
    const sh::Quadrature q = sh::quadrature(3 * (order - 1));
    std::vector<double> expected(f.size(), 0.0);
    for (std::size_t p = 0; p < q.weight.size(); ++p) {
      const std::vector<double> y = sh::evaluate(order, q.direction[p]);
      const double value = sh::reconstruct(f, q.direction[p]) * sh::reconstruct(g, q.direction[p]);
      for (std::size_t i = 0; i < y.size(); ++i) expected[i] += q.weight[p] * value * y[i];
    }
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(product[i], expected[i], 1e-11);
    double dot = 0.0;
    const auto h = random_coefficients(order, 3);
    for (std::size_t i = 0; i < f.size(); ++i) dot += product[i] * h[i];
    EXPECT_NEAR(sh::tensor(order).triple_product(f, g, h), dot, 1e-11);
    EXPECT_NEAR(sh::tensor(order).triple_product(h, f, g), dot, 1e-11) << "in any order";
  }
}

TEST(SphericalHarmonics, OneIsTheUnitOfTheProduct) {
  for (int order = 2; order <= 6; ++order) {
    const auto f = random_coefficients(order, 4);
    std::vector<double> one(f.size(), 0.0);
    one[0] = std::sqrt(4.0 * pi);
    const auto product = sh::tensor(order).product(one, f);
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(product[i], f[i], 1e-12);
  }
}

/// Runs the test once per instruction set present.
template <class Test>
void on_every_target(Test test) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    test();
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
}

TEST(SphericalHarmonics, VectorisedProductsEqualTheOracle) {
  on_every_target([] {
    for (int order = 2; order <= 6; ++order) {
      const auto size = std::size_t(sh::coefficients(order));
      for (const int count : {1, 15, 16, 17, 40}) {
        std::vector<float> f(sh::batch_floats(order, count)), g(f), out(f);
        const auto at = [&](int k, std::size_t i) { return (std::size_t(k / 16) * size + i) * 16 + k % 16; };
        for (int k = 0; k < count; ++k) {
          const auto a = floats(random_coefficients(order, 10 + k)), b = floats(random_coefficients(order, 90 + k));
          for (std::size_t i = 0; i < size; ++i) f[at(k, i)] = a[i], g[at(k, i)] = b[i];
        }
        sh::product_batch(order, f.data(), g.data(), count, out.data());
        sh::square_batch(order, f.data(), count, f.data());
        for (int k = 0; k < count; ++k) {
          const auto a = random_coefficients(order, 10 + k), b = random_coefficients(order, 90 + k);
          const auto oracle = sh::tensor(order).product(a, b);
          std::vector<float> one(size);
          sh::product(order, floats(a).data(), floats(b).data(), one.data());
          const auto squared = sh::tensor(order).product(a, a);
          for (std::size_t i = 0; i < size; ++i) {
            ASSERT_NEAR(double(f[at(k, i)]), squared[i], 1e-5)
                << instruction_set_of_kernels() << " " << order << " " << i;
            ASSERT_NEAR(double(out[at(k, i)]), oracle[i], 1e-5)
                << instruction_set_of_kernels() << " " << order << " " << i;
            ASSERT_NEAR(double(one[i]), oracle[i], 1e-5) << instruction_set_of_kernels() << " " << order << " " << i;
          }
        }
      }
    }
  });
}

TEST(SphericalHarmonics, VectorisedEvaluationEqualsTheOracle) {
  on_every_target([] {
    for (int order = 1; order <= sh::max_order; ++order) {
      constexpr int count = 33, padded = 48;
      const auto size = std::size_t(sh::coefficients(order));
      std::vector<float> w[3];
      for (auto& axis : w) axis.assign(padded, 0.0f);
      for (int k = 0; k < count; ++k)
        for (int c = 0; c < 3; ++c) w[c][k] = float(direction(k)[c]);
      const float* const pointers[3] = {w[0].data(), w[1].data(), w[2].data()};
      std::vector<float> y(sh::batch_floats(order, count));
      sh::evaluate_batch(order, pointers, count, y.data());
      for (int k = 0; k < count; ++k) {
        const auto oracle = sh::evaluate(order, direction(k));
        for (std::size_t i = 0; i < size; ++i)
          ASSERT_NEAR(double(y[(std::size_t(k / 16) * size + i) * 16 + k % 16]), oracle[i], 2e-5)
              << instruction_set_of_kernels();
      }
    }
  });
}

TEST(SphericalHarmonics, RotationTurnsTheFunction) {
  for (int order = 1; order <= sh::max_order; ++order) {
    const auto c = random_coefficients(order, 5);
    const glm::dmat3 q = turn(1.1, glm::normalize(dvec3(1, -2, 0.5)));
    const auto turned = sh::Rotation(order, q)(c);
    for (std::uint32_t k = 0; k < 20; ++k)
      EXPECT_NEAR(sh::reconstruct(turned, q * direction(k)), sh::reconstruct(c, direction(k)), 1e-11);
    for (int l = 0; l < order; ++l) {  // the energy of a band stays
      double before = 0.0, after = 0.0;
      for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i) before += c[i] * c[i], after += turned[i] * turned[i];
      EXPECT_NEAR(before, after, 1e-11);
    }
  }
  EXPECT_NE(test::error_of([] { sh::Rotation(3, glm::dmat3(2.0)); }).find("not orthogonal"), std::string::npos);
}

TEST(SphericalHarmonics, RotationsInSinglePrecisionAndInBatches) {
  for (int order = 1; order <= sh::max_order; ++order) {
    const sh::Rotation r(order, turn(2.3, glm::normalize(dvec3(-1, 0.2, 3))));
    const auto size = std::size_t(sh::coefficients(order));
    constexpr int count = 21;  // a whole block and a part
    std::vector<float> batch(sh::batch_floats(order, count));
    std::vector<std::vector<double>> expected;
    for (int k = 0; k < count; ++k) {
      const auto c = random_coefficients(order, std::uint32_t(30 + k));
      expected.push_back(r(c));
      std::vector<float> one(size);
      r(floats(c).data(), one.data());
      for (std::size_t i = 0; i < size; ++i) {
        EXPECT_NEAR(double(one[i]), expected.back()[i], 2e-6) << order;
        batch[(std::size_t(k / sh::block) * size + i) * sh::block + std::size_t(k % sh::block)] = float(c[i]);
      }
    }
    on_every_target([&] {
      std::vector<float> turned = batch;
      sh::rotate_batch(r, turned.data(), count, turned.data());
      for (int k = 0; k < count; ++k)
        for (std::size_t i = 0; i < size; ++i)
          ASSERT_NEAR(double(turned[(std::size_t(k / sh::block) * size + i) * sh::block + std::size_t(k % sh::block)]),
                      expected[std::size_t(k)][i], 2e-6)
              << order << " " << instruction_set_of_kernels();
    });
  }
}

TEST(SphericalHarmonics, ProductsAndRotationsCommute) {
  const auto f = random_coefficients(5, 6), g = random_coefficients(5, 7);
  const sh::Rotation r(5, turn(0.7, glm::normalize(dvec3(3, 1, 2))));
  const auto a = r(sh::tensor(5).product(f, g)), b = sh::tensor(5).product(r(f), r(g));
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-11);
}

TEST(SphericalHarmonics, ZonalRotationIsARotation) {
  const sh::Zonal zonal = {0.3, -0.7, 1.1, 0.2, 0.5};
  std::vector<double> c(25, 0.0);
  for (int l = 0; l < 5; ++l) c[sh::index(l, 0)] = zonal[l];
  const glm::dmat3 q = turn(0.9, glm::normalize(dvec3(0.2, 1, 0.4)));
  const auto full = sh::Rotation(5, q)(c), quick = sh::rotate_zonal(zonal, q * dvec3(0, 0, 1));
  float straight[25];
  const vec3 axis(q * dvec3(0, 0, 1));
  sh::rotate_zonal<5>(floats(zonal).data(), axis.x, axis.y, axis.z, straight);
  for (int i = 0; i < 25; ++i) {
    EXPECT_NEAR(full[i], quick[i], 1e-12);
    EXPECT_NEAR(double(straight[i]), quick[i], 1e-5);
  }
}

/// Zonal coefficients of f(cos theta), by integration over z between the ends of what is smooth.
sh::Zonal zonal_by_integration(int order, double low, double high, const std::function<double(double)>& f) {
  const sh::GaussLegendre rule = sh::gauss_legendre(40);
  sh::Zonal out(std::size_t(order), 0.0);
  for (std::size_t p = 0; p < rule.node.size(); ++p) {
    const double z = 0.5 * (low + high) + 0.5 * (high - low) * rule.node[p];
    for (int l = 0; l < order; ++l)
      out[l] += pi * (high - low) * rule.weight[p] * f(z) * std::sqrt((2 * l + 1) / (4 * pi)) * sh::legendre(l, z);
  }
  return out;
}

TEST(SphericalHarmonics, CosineLobe) {
  const sh::Zonal a = sh::cosine_lobe(10), integral = zonal_by_integration(10, 0.0, 1.0, [](double z) { return z; });
  EXPECT_NEAR(a[0], std::sqrt(pi) / 2, 1e-14);
  EXPECT_NEAR(a[1], std::sqrt(pi / 3), 1e-14);
  EXPECT_NEAR(a[2], std::sqrt(5 * pi) / 8, 1e-14);
  EXPECT_NEAR(a[4], -std::sqrt(pi) / 16, 1e-14);
  for (int l = 0; l < 10; ++l) EXPECT_NEAR(a[l], integral[l], 1e-13) << l;
}

TEST(SphericalHarmonics, OrderThreeCosineKernelIsNotZeroBelow) {  // hard case 36
  const auto c = sh::rotate_zonal(sh::cosine_lobe(3), {0, 0, 1});
  EXPECT_NEAR(sh::reconstruct(c, {0, 0, 1}), 1.0625, 1e-12);
  EXPECT_NEAR(sh::reconstruct(c, {1, 0, 0}), 0.09375, 1e-12);
  EXPECT_NEAR(sh::reconstruct(c, {0, 0, -1}), 0.0625, 1e-12);
}

TEST(SphericalHarmonics, CapVisibility) {
  for (const double theta : {0.0, 0.2, 0.9, pi / 2}) {
    const sh::Zonal v = sh::cap_visibility(10, theta),
                    integral = zonal_by_integration(10, -1.0, std::cos(theta), [](double) { return 1.0; });
    for (int l = 0; l < 10; ++l) EXPECT_NEAR(v[l], integral[l], 1e-12) << theta << " " << l;
  }
}

TEST(SphericalHarmonics, Windows) {
  const auto hann = sh::window(sh::Window::hann, 4), lanczos = sh::window(sh::Window::lanczos, 4),
             laplacian = sh::window(sh::Window::laplacian, 3, 0.1), none = sh::window(sh::Window::none, 4);
  for (const auto& w : {hann, lanczos, laplacian, none}) EXPECT_EQ(w[0], 1.0);
  EXPECT_NEAR(hann[2], 0.5, 1e-14);
  EXPECT_NEAR(lanczos[2], 2.0 / pi, 1e-14);
  EXPECT_NEAR(laplacian[1], 1.0 / 1.4, 1e-14);
  EXPECT_NEAR(laplacian[2], 1.0 / (1.0 + 0.1 * 36), 1e-14);
  EXPECT_EQ(none[3], 1.0);
  std::vector<double> c = {1, 1, 1, 1};
  sh::apply_window(sh::window(sh::Window::hann, 2), c);
  EXPECT_EQ(c, (std::vector<double>{1, 0.5, 0.5, 0.5}));
  EXPECT_NE(test::error_of([] { sh::parse_window("gauss"); }).find("none, hann, lanczos or laplacian"),
            std::string::npos);
}

TEST(SphericalHarmonics, StratifiedProjection) {
  const auto directions = sh::stratified_directions(100, 1);
  ASSERT_EQ(directions.size(), 10000u);
  const auto constant = sh::project_samples(4, directions, [](dvec3) { return 1.0; });
  EXPECT_NEAR(constant[0], std::sqrt(4 * pi), 1e-10) << "DC of a constant is exact";
  double worst = 0.0;  // entries of the Gram matrix
  for (int i = 0; i < 16; ++i) {
    const auto row = sh::project_samples(4, directions, [&](dvec3 w) { return sh::evaluate(4, w)[i]; });
    for (int j = 0; j < 16; ++j) worst = std::max(worst, std::abs(row[j] - (i == j ? 1.0 : 0.0)));
  }
  EXPECT_LT(worst, 3e-3);
  EXPECT_GT(worst, 1e-5) << "they are random";
  EXPECT_NE(test::error_of([] { sh::stratified_directions(0, 1); }).find("at least 1"), std::string::npos);
}

/// The same piecewise constant light, integrated by brute force.
std::vector<double> project_by_subdivision(int order, const Environment& e, int channel) {
  std::vector<double> c(std::size_t(sh::coefficients(order)), 0.0);
  constexpr int fine = 24;
  for (int t = 0; t < int(e.radiance.size()); ++t)
    for (int a = 0; a < fine; ++a)
      for (int b = 0; b < fine; ++b) {
        float pdf = 0.0f;
        const vec3 w = e.direction(t, (float(a) + 0.5f) / fine, (float(b) + 0.5f) / fine, &pdf);
        const auto y = sh::evaluate(order, w);
        for (std::size_t i = 0; i < c.size(); ++i)
          c[i] += double(e.radiance[t][channel]) * y[i] / double(pdf) / (fine * fine);
      }
  return c;
}

TEST(SphericalHarmonics, TexelProjectionIsTheIntegral) {
  for (const Mapping mapping : {Mapping::lat_long, Mapping::cube}) {
    Environment e;
    e.mapping = mapping;
    e.width = mapping == Mapping::cube ? 3 : 8, e.height = mapping == Mapping::cube ? 18 : 4;
    for (int t = 0; t < e.width * e.height; ++t) {
      const RandomTriple r = random_triple(3, std::uint32_t(t));
      e.radiance.emplace_back(r.x, r.y, r.z);
    }
    for (const double rotation : {0.0, 1.3}) {
      e.rotation = rotation;
      sh::LightProjection projection(6);
      const sh::LightCoefficients& exact = projection.update(e);
      for (int c = 0; c < 3; ++c) {
        const auto brute = project_by_subdivision(6, e, c);
        for (std::size_t i = 0; i < brute.size(); ++i) EXPECT_NEAR(exact.channel[c][i], brute[i], 4e-3) << i;
      }
    }
  }
}

TEST(SphericalHarmonics, ConstantLightHasNothingButDc) {
  sh::LightProjection projection(10);
  Environment e = test::constant_environment();
  for (const Mapping mapping : {Mapping::cube, Mapping::lat_long}) {
    if (mapping == Mapping::lat_long) e = {mapping, 64, 32, std::vector<vec3>(64 * 32, vec3(1.0f)), 0.4};
    const auto c = projection.update(e).channel[1];
    EXPECT_NEAR(c[0], std::sqrt(4 * pi), 1e-12);
    for (std::size_t i = 1; i < c.size(); ++i) EXPECT_NEAR(c[i], 0.0, 1e-8);  // directions of cube texels are floats
  }
}

TEST(SphericalHarmonics, TurnedLightIsTheRotatedProjection) {
  Environment e;
  make_environment("lamps", e);
  sh::LightProjection kept(4), fresh(4);
  kept.update(e);
  e.rotation = 0.8;
  const auto turned = kept.update(e), projected = fresh.update(e);
  e.radiance[1000] += vec3(5.0f);
  const auto changed = kept.update(e);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(turned.channel[0][i], projected.channel[0][i]);
  EXPECT_NE(changed.channel[0][0], turned.channel[0][0]) << "a changed texel is seen";
}

}  // namespace
}  // namespace penumbra
