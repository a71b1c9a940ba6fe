// Logarithm and exponential against closed forms and the published table, and the technique's guards.
#include "harness/catalogue/catalogue.h"
#include "techniques/sh_exponentiation/exponential.h"

#include "harness/measure/parity.h"
#include "scenes/scene_file.h"
#include "techniques/bases/random.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/tensor.h"
#include "techniques/sh_exponentiation/hierarchy.h"
#include "techniques/sh_exponentiation/kernel.h"
#include "tests/support.h"

namespace penumbra::sh_exponentiation {
namespace {

constexpr double degree = pi / 180.0;

/// The logarithm of one cap about a tilted axis.
std::vector<double> tilted_logarithm(int order, double theta) {
  return sh::rotate_zonal(cap_logarithm(order, theta), glm::normalize(dvec3(0.3, -0.5, 0.8)));
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double squared = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squared += (a[i] - b[i]) * (a[i] - b[i]), energy += b[i] * b[i];
  return std::sqrt(squared / energy);
}

double norm_without_dc(const std::vector<double>& f) {
  double squared = 0.0;
  for (std::size_t i = 1; i < f.size(); ++i) squared += f[i] * f[i];
  return std::sqrt(squared);
}

const LinearFit& caps(int order) {
  static const LinearFit fits[] = {fit_to_caps(LogTable(4)), fit_to_caps(LogTable(5)), fit_to_caps(LogTable(6))};
  return fits[order - 4];
}

TEST(ShExponential, LogarithmsOfCapsAreThePublishedOnes) {
  const double expected[3][4] = {
      {-0.364, -0.565, -0.619, -0.562}, {-2.701, -3.849, -3.234, -1.846}, {-6.206, -6.124, -1.487, 1.461}};
  for (int k = 0; k < 3; ++k) {
    const auto f = cap_logarithm(4, (k + 1) * 30.0 * degree);
    for (int l = 0; l < 4; ++l) EXPECT_NEAR(f[l], expected[k][l], 6e-4) << k << " " << l;
  }
}

TEST(ShExponential, TableInterpolatesTheLogarithms) {
  for (const int order : {4, 6}) {
    const LogTable table(order);
    for (double theta = 0.5 * degree; theta < 90.0 * degree; theta += 3.7 * degree) {
      const auto f = cap_logarithm(order, theta);
      for (int l = 0; l < order; ++l)
        EXPECT_NEAR(table.look_up(l, std::cos(theta)), std::sqrt(4 * pi / (2 * l + 1)) * f[l], 2e-3) << theta;
    }
    EXPECT_EQ(table.look_up(0, 1.0), 0.0) << "nothing is blocked by a cap of no size";
  }
}

TEST(ShExponential, ExponentialUndoesTheLogarithm) {
  for (int order = 4; order <= 6; ++order)
    for (const double theta : {5.0, 10.0, 15.0}) {  // below the clamp of eigenvalues; log* is cut to the order, too
      const auto f = tilted_logarithm(order, theta * degree);
      const auto v = sh::rotate_zonal(sh::cap_visibility(order, theta * degree), glm::normalize(dvec3(0.3, -0.5, 0.8)));
      EXPECT_LT(distance(exponential({Exponential::exact}, caps(order), f), v), 1e-5) << order << " " << theta;
    }
}

TEST(ShExponential, ConstantsExponentiateAlone) {  // hard case 35
  for (int order = 4; order <= 6; ++order)
    for (const Exponential kind :
         {Exponential::optimal_linear, Exponential::hybrid, Exponential::power_series, Exponential::exact})
      for (const double c : {0.0, -0.7, -3.0, 1.2}) {
        std::vector<double> f(std::size_t(sh::coefficients(order)), 0.0);
        f[0] = c * std::sqrt(4 * pi);
        const auto g = exponential({kind}, caps(order), f);
        EXPECT_NEAR(g[0], std::exp(c) * std::sqrt(4 * pi), 1e-6 * std::exp(c));
        for (std::size_t i = 1; i < g.size(); ++i) EXPECT_NEAR(g[i], 0.0, 1e-12);
      }
  for (int order = 4; order <= 6; ++order) {
    EXPECT_EQ(caps(order).a[0], 1.0f);
    EXPECT_EQ(caps(order).b[0], 1.0f);
  }
}

TEST(ShExponential, OptimalLinearIsThePublishedOne) {
  const double expected[3][3] = {{1.009, 1.034, 0.772}, {5.355, 1.607, 0.526}, {6.469, 2.880, 1.411}};
  for (int k = 0; k < 3; ++k) {
    const double norm = norm_without_dc(tilted_logarithm(4, (k + 1) * 30.0 * degree));
    EXPECT_NEAR(norm, expected[k][0], 1e-3);
    EXPECT_NEAR(caps(4).look_up_a(norm), expected[k][1], 2e-2) << "60 to 90 degrees lie close together in |f|";
    EXPECT_NEAR(caps(4).look_up_b(norm), expected[k][2], 2e-2);
  }
  EXPECT_EQ(caps(4).look_up_a(1e6), double(caps(4).a.back())) << "beyond the table the last holds";
}

TEST(ShExponential, PowerSeriesConverges) {  // on one cap of 50 degrees
  const auto f = tilted_logarithm(4, 50.0 * degree), exact = exponential({Exponential::exact}, caps(4), f);
  const auto error = [&](int terms) {
    return distance(exponential({Exponential::power_series, terms}, caps(4), f), exact);
  };
  EXPECT_NEAR(error(2), 0.75, 0.02);
  EXPECT_NEAR(error(4), 0.52, 0.02);
  EXPECT_LT(error(9), 0.01);
  EXPECT_LT(error(30), 1e-9);
  EXPECT_GT(error(0), 0.1) << "zero terms: the constant alone";
}

TEST(ShExponential, HybridTendsToTheExactExponential) {
  auto f = tilted_logarithm(4, 45.0 * degree);
  const auto g = sh::rotate_zonal(cap_logarithm(4, 0.5), {0, 1, 0});
  for (std::size_t i = 0; i < f.size(); ++i) f[i] += g[i];
  const auto exact = exponential({Exponential::exact}, caps(4), f);
  double before = 1.0;
  for (const double tau : {4.8, 1.0, 0.25, 0.06}) {
    const double error = distance(exponential({Exponential::hybrid, 9, tau}, caps(4), f), exact);
    EXPECT_LT(error, before);
    before = error;
  }
  EXPECT_LT(before, 0.01);
}

TEST(ShExponential, FitToSetsIsNearTheFitToCapsWhereBothAreSmall) {
  const LinearFit sets = fit_to_sets(LogTable(4));
  EXPECT_EQ(sets.a[0], 1.0f);
  EXPECT_EQ(sets.b[0], 1.0f);
  for (const double norm : {0.3, 1.0}) {
    EXPECT_NEAR(sets.look_up_a(norm), caps(4).look_up_a(norm), 0.05);
    EXPECT_NEAR(sets.look_up_b(norm), caps(4).look_up_b(norm), 0.12);
  }
}

TEST(ShExponential, BadMethodsAreRefused) {
  const std::vector<double> f(16, 0.0);
  EXPECT_NE(test::error_of([&] {
              exponential({Exponential::power_series, -1}, caps(4), f);
            }).find("-1 terms"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              exponential({Exponential::hybrid, 9, 0.0}, caps(4), f);
            }).find("must be positive"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              exponential({Exponential::hybrid, 9, NAN}, caps(4), f);
            }).find("must be positive"),
            std::string::npos);
  EXPECT_NE(test::error_of([] { parse_exponential("exp"); }).find("optimal-linear, hybrid"), std::string::npos);
  const Registry registry = make_registry();
  for (const char* bad : {"tau=0", "tau=-1.5", "terms=-1", "order=3", "order=0", "order=11", "exponential=ps"})
    EXPECT_NE(test::error_of([&] {
                make_technique(registry.find("sh-exponentiation", "simd"), parse_parameters({bad}));
              }).find(std::string(bad).substr(0, std::string(bad).find('='))),
              std::string::npos)
        << bad;
}

/// Why the guard must be: the logarithm of a set with duplicates has positive eigenvalues through ringing.
TEST(ShExponential, UnguardedDuplicatesDiverge) {
  const auto once = tilted_logarithm(4, 30.0 * degree);
  const auto e = [&](double copies) {
    std::vector<double> f = once;
    for (double& value : f) value *= copies;
    const auto v = exponential({Exponential::exact}, caps(4), f);
    double sum = 0.0;  // at the normal that is the cap's axis
    const auto lobe = sh::rotate_zonal(sh::cosine_lobe(4), glm::normalize(dvec3(0.3, -0.5, 0.8)));
    for (std::size_t i = 0; i < v.size(); ++i) sum += lobe[i] * v[i];
    return sum / pi;
  };
  EXPECT_NEAR(e(1), 0.75, 0.01);
  EXPECT_NEAR(e(2), 0.63, 0.02);
  EXPECT_NEAR(e(4), 0.58, 0.02);
  EXPECT_LT(e(100), -0.5) << "radiance below zero";
  EXPECT_GT(std::abs(e(1000)), 1e9);
}

struct Way {
  const char* backend;
  const char* exponential;
  friend void PrintTo(const Way& w, std::ostream* out) { *out << w.backend << " " << w.exponential; }
};

class ShExponentiation : public testing::TestWithParam<Way> {
 protected:
  struct Result {
    vec3 e;
    std::map<std::string, std::size_t> counters;
  };
  static Result shaded(const std::vector<Sphere>& spheres, std::vector<std::string> parameters = {}) {
    parameters.push_back(std::string("exponential=") + GetParam().exponential);
    const Registry registry = make_registry();
    const auto technique =
        make_technique(registry.find("sh-exponentiation", GetParam().backend), parse_parameters(parameters));
    const Scene scene = test::sphere_scene(spheres, test::receivers_at({vec3(0.0f)}));
    const vec3 e = test::shade(*technique, scene)[0];
    return {e, technique->counters()};
  }
};

TEST_P(ShExponentiation, CapsComeNearTheirClosedForms) {
  for (const double theta : {0.1, 0.4, 0.7})
    for (const double tilt : {0.0, 0.5}) {
      const vec3 v(float(std::sin(tilt)), float(std::cos(tilt)), 0.0f);
      EXPECT_NEAR(double(shaded({test::cap_sphere(v, theta)}).e.x), 1 - std::pow(std::sin(theta), 2) * std::cos(tilt),
                  0.02)
          << theta << " " << tilt;
    }
}

TEST_P(ShExponentiation, DuplicatesAndCoveredSpheresCountOnce) {  // hard cases 9, 10, 12
  const Sphere outer = test::cap_sphere({0.2f, 1, 0}, 0.5), inner{outer.centre, 0.5f * outer.radius};
  const Result one = shaded({outer}), many = shaded(std::vector<Sphere>(1000, outer)), nested = shaded({inner, outer});
  EXPECT_EQ(many.e, one.e);
  EXPECT_EQ(nested.e, one.e);
  EXPECT_EQ(many.counters.at("covered_spheres"), 999u);
  EXPECT_EQ(nested.counters.at("covered_spheres"), 1u);
}

/// Copies that differ too much to be dropped: whatever the exponential makes of them, what is written can be shown.
TEST_P(ShExponentiation, NearDuplicatesStayInRange) {
  for (const int copies : {100, 1000, 30000}) {
    std::vector<Sphere> spheres;
    for (int k = 0; k < copies; ++k) {
      const RandomTriple r = random_triple(5, std::uint32_t(k));
      spheres.push_back({vec3(0.01f * r.x, 1.0f + 0.01f * r.y, 0.01f * r.z), 0.5f});
    }
    const Result result = shaded(spheres);
    for (int c = 0; c < 3; ++c) {
      EXPECT_TRUE(std::isfinite(result.e[c]));
      EXPECT_GE(result.e[c], 0.0f);
      EXPECT_LE(result.e[c], 1.0f + 1e-5f);
    }
  }
}

TEST_P(ShExponentiation, InsideASphereOrWithoutAny) {
  EXPECT_LT(shaded({{{0, 0.2f, 0}, 1.0f}}).e.x, 0.1f) << "contact: order 4 leaks up to 0.09";
  EXPECT_NEAR(shaded({{{0, -3, 0}, 1.0f}}).e.x, 1.0f, 1e-5f) << "wholly below";
  EXPECT_NEAR(shaded({{{0, -0.5f, 0}, 1.0f}}).e.x, 1.0f, 1e-5f) << "around x, centre below: x's own";
}

INSTANTIATE_TEST_SUITE_P(EveryWay, ShExponentiation,
                         testing::Values(Way{"scalar", "hybrid"}, Way{"simd", "hybrid"}, Way{"scalar", "exact"},
                                         Way{"simd", "exact"}, Way{"simd", "power-series"}));

/// Large logarithms: a series that ends too early, or steps that are too long, show here and not under a small
/// occluder.
TEST(ShExponential, BackendsAreExactWhereMuchIsBlocked) {
  std::vector<Sphere> spheres;
  for (const vec3 axis : {vec3(0, 1, 0), vec3(1, 0.8f, 0), vec3(-0.9f, 1, 0.2f), vec3(0, 1, 1), vec3(0.1f, 0.9f, -1)})
    spheres.push_back(test::cap_sphere(axis, 0.55));
  const Scene scene =
      test::sphere_scene(spheres, test::receivers_at({vec3(0.0f), vec3(0.1f, 0, 0), vec3(-1, 0, 0.3f)}));
  for (const char* order : {"order=4", "order=6"}) {
    const std::vector<std::string> exact = {"exponential=exact", "hierarchy=off", order};
    const auto scalar = test::shade("sh-exponentiation", "scalar", exact, scene);
    for (const char* backend : {"simd", "cuda"})
      EXPECT_LT(test::difference(test::shade("sh-exponentiation", backend, exact, scene), scalar), 1e-4)
          << backend << " " << order;
  }
}

TEST(ShGuard, NotANumberIsCountedAndBlack) {
  for (const char* backend : {"scalar", "simd"})
    for (const char* kind : {"exponential=hybrid", "exponential=optimal-linear", "exponential=power-series"}) {
      const Registry registry = make_registry();
      const auto technique =
          make_technique(registry.find("sh-exponentiation", backend), parse_parameters({kind, "terms=3"}));
      Scene scene = test::sphere_scene({test::cap_sphere({0, 1, 0}, 0.5)}, test::receivers_at({vec3(0.0f), vec3(NAN)}));
      const auto image = test::shade(*technique, scene);
      EXPECT_GT(image[0].x, 0.5f) << "the neighbour is well";
      EXPECT_EQ(image[1], vec3(0.0f)) << backend << " " << kind;
      EXPECT_EQ(technique->counters().at("non_finite"), 3u) << backend << " " << kind;
    }
}

TEST(ShGuard, CountsWhatIsNotFinite) {
  std::size_t bad = 0, clamped = 0;
  EXPECT_EQ(guarded(NAN, 1.0f, bad, clamped), 0.0f);
  EXPECT_EQ(guarded(INFINITY, 1.0f, bad, clamped), 0.0f);
  EXPECT_EQ(bad, 2u);
  EXPECT_EQ(guarded(-0.5f, 1.0f, bad, clamped), 0.0f);
  EXPECT_EQ(guarded(1.5f, 1.0f, bad, clamped), 1.0f);
  EXPECT_EQ(guarded(0.5f, 1.0f, bad, clamped), 0.5f);
  EXPECT_EQ(guarded(0.5f, -0.1f, bad, clamped), 0.0f) << "a window can make the unshadowed light negative";
  EXPECT_EQ(clamped, 3u);
}

TEST(ShSelfShadow, RuleOfRen2006) {
  const vec3 up(0, 1, 0), x(0.0f);
  const auto shadow = [&](Sphere s, bool own = false) { return shadow_of(s, x, up, own, true); };
  EXPECT_EQ(shadow({{0, -2, 0}, 1.0f}).share, 0.0f) << "wholly under the plane";
  EXPECT_EQ(shadow({{0, -0.5f, 0}, 1.0f}).share, 0.0f) << "around x, centre below";
  EXPECT_EQ(shadow({{0, 3, 0}, 0.0f}).share, 0.0f) << "no size";
  const Shadow around = shadow({{0, 0.5f, 0}, 1.0f});
  EXPECT_EQ(around.share, 1.0f);
  EXPECT_EQ(around.cosine, 0.0f);
  EXPECT_EQ(shadow({{0, 0.5f, 0}, 1.0f}, true).share, 0.0f) << "its own surface";
  const Shadow high = shadow({{0, 2, 0}, 1.0f});
  EXPECT_FLOAT_EQ(high.cosine, std::sqrt(0.75f));
  EXPECT_FLOAT_EQ(high.axis.y, 1.0f);
  for (const double h : {-0.75, -0.5, 0.0, 0.5, 0.999, 1.0, 1.5}) {  // radius 1: below 1 it pokes through the plane
    const double resting = h < 1.0 ? 0.5 * (1.0 + h) : 1.0, centre = h < 1.0 ? resting : h;
    const double square = 9.0 + centre * centre;
    const Shadow found = shadow({{3, float(h), 0}, 1.0f});
    EXPECT_NEAR(found.share, h < 0.0 ? 1.0 + h : 1.0, 1e-6) << h;
    EXPECT_NEAR(found.cosine, std::sqrt(1 - resting * resting / square), 1e-6) << h;
    EXPECT_NEAR(found.axis.y, centre / std::sqrt(square), 1e-6) << h;
    EXPECT_NEAR(found.axis.x, 3.0 / std::sqrt(square), 1e-6) << h;
  }
  EXPECT_NEAR(shadow_of({{3, 0, 0}, 1.0f}, x, up, false, false).cosine, std::sqrt(1 - 1.0 / 9), 1e-6) << "kept";
}

TEST(ShHierarchy, CutsAreFinerNearby) {
  const Scene scene = load_scene("bunny-city");
  const LogTable table(4);
  const SphereTree tree(scene.spheres);
  std::vector<WeightedSphere> near, middle, far;
  tree.cut(table, {{0.8f, 0, 0}, 0.1f}, near);
  tree.cut(table, {{2.4f, 0, 0}, 0.1f}, middle);
  tree.cut(table, {{50, 0, 0}, 0.1f}, far);
  EXPECT_GT(near.size(), middle.size());
  EXPECT_GT(middle.size(), far.size());
  EXPECT_EQ(far.size(), 1u) << "the whole bunny is one small sphere";
  EXPECT_LE(near.size(), scene.spheres.size());
  EXPECT_EQ(far[0].weight[0], 1.0f) << "below 5 degrees it stands for itself";
  int weighted = 0;
  for (const WeightedSphere& s : middle) {
    EXPECT_TRUE(s.weight[0] > 0.05f && s.weight[0] < 4.0f) << s.weight[0];
    weighted += s.bound && s.weight[0] < 0.95f;
  }
  EXPECT_GT(weighted, 0) << "a bound blocks too much";
  EXPECT_TRUE(SphereTree(SphereSet{}).empty());
}

/// Logarithm of the visibility behind a sphere, as a receiver at x adds it.
std::vector<double> logarithm_at(const LogTable& table, const Sphere& sphere, vec3 x) {
  const vec3 to = sphere.centre - x;
  const double sine = double(sphere.radius) / double(glm::length(to));
  std::vector<double> f = sh::evaluate(table.order(), glm::normalize(dvec3(to)));
  for (std::size_t i = 0; i < f.size(); ++i) f[i] *= table.look_up(sh::band(int(i)), std::sqrt(1.0 - sine * sine));
  return f;
}

/// A bound of four spheres that looks 14 degrees large stands for them: band by band the share of its logarithm that
/// comes nearest to the sum of theirs.
TEST(ShHierarchy, WeightsFitTheSumOfTheSpheres) {
  const LogTable table(4);
  const SphereSet set{
      {{{-0.6f, 4, 0.1f}, 0.3f}, {{-0.2f, 4.1f, 0}, 0.25f}, {{0.3f, 3.9f, 0}, 0.35f}, {{0.7f, 4, 0}, 0.2f}}};
  std::vector<WeightedSphere> cut;
  SphereTree(set).cut(table, {vec3(0.0f), 0.01f}, cut);
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_TRUE(cut[0].bound);
  const std::vector<double> bound = logarithm_at(table, cut[0].sphere, vec3(0.0f));
  std::vector<double> sum(bound.size(), 0.0);
  for (const Sphere& s : set.spheres) {
    const std::vector<double> f = logarithm_at(table, s, vec3(0.0f));
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += f[i];
  }
  for (int l = 0; l < 4; ++l) {
    double cross = 0.0, square = 0.0;
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i)
      cross += bound[std::size_t(i)] * sum[std::size_t(i)], square += bound[std::size_t(i)] * bound[std::size_t(i)];
    EXPECT_NEAR(cut[0].weight[std::size_t(l)], cross / square, 2e-3) << l;
  }
  EXPECT_LT(cut[0].weight[0], 0.8f) << "the bound alone would block too much";
}

TEST(ShHierarchy, ErrorIsSmall) {
  Scene scene = thinned(load_scene("torus-knot-lamps"), 32);
  const auto off = test::shade("sh-exponentiation", "simd", {"hierarchy=off"}, scene),
             on = test::shade("sh-exponentiation", "simd", {"hierarchy=on"}, scene);
  EXPECT_LT(test::difference(on, off), 0.02);
  EXPECT_GT(test::difference(on, off), 0.0) << "it does something";
}

TEST(ShHierarchy, ClustersHoldEveryReceiverOnce) {
  const Scene scene = load_scene("bunny-city");
  std::vector<int> seen(std::size_t(scene.receivers.size()), 0);
  for (const Cluster& c : make_clusters(scene.receivers, 0.25f))
    for (const int i : c.receivers) {
      ++seen[i];
      EXPECT_LE(glm::length(scene.receivers.position[i] - c.bound.centre), c.bound.radius * 1.0001f);
    }
  for (const int count : seen) ASSERT_EQ(count, 1);
}

}  // namespace
}  // namespace penumbra::sh_exponentiation
