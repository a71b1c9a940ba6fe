#include "techniques/bases/sphere_table.h"

#include "scenes/cube_map.h"
#include "techniques/bases/random.h"
#include "tests/support.h"

namespace penumbra {
namespace {

std::vector<vec3> texel_directions(int n) {
  std::vector<vec3> directions;
  for (int t = 0; t < 6 * n * n; ++t) directions.push_back(cube_texel_direction(t, n));
  return directions;
}

vec3 random_direction(std::uint32_t k) {
  const RandomTriple r = random_triple(7, k);
  const float z = 2 * r.x - 1, s = std::sqrt(1 - z * z), a = float(2 * pi) * r.y;
  return {s * std::cos(a), s * std::sin(a), z};
}

class SphereTables : public testing::Test {
 protected:
  static const SphereTable& table() {
    static const SphereTable instance(SphereTable::published(32, RadiusBins::uniform_angle));
    return instance;
  }
  static const SphereTable& fine() {
    static const SphereTable instance(SphereTable::fine(32));
    return instance;
  }
  const std::vector<vec3> directions_ = texel_directions(32);
};

TEST_F(SphereTables, HasThePublishedEntries) {
  EXPECT_EQ(table().entries().size() * std::size_t(table().words()) * 4, 150994944u) << "144 MiB, were all words kept";
  EXPECT_LT(table().bytes(), 150994944u);
  EXPECT_LT(fine().bytes(), std::size_t(256) << 20);
}

TEST_F(SphereTables, EntriesAreTheCapsTheyStandFor) {
  for (const SphereTable* of : {&table(), &fine()}) {
    const auto [n, edge, bins, scheme, widest] = of->shape();
    for (std::uint32_t k = 0; k < 200; ++k) {
      const int texel = int(random_triple(1, k).x * float(6 * edge * edge)), bin = int(k) % bins;
      BitCube wanted(32), got(32);
      const Cap cap{cube_texel_direction(texel, edge), of->cosine(bin)};
      for (int t = 0; t < 6144; ++t)
        if (covers(cap, directions_[t])) wanted.set(t);
      of->merge(texel * bins + bin, got);
      ASSERT_EQ(got.words, wanted.words) << texel << " " << bin;
      if (edge == 32) EXPECT_GE(wanted.count(), 1) << "an entry at its own texel sets at least one bit";
    }
  }
}

TEST_F(SphereTables, EntriesKeepNoLineWithoutBits) {
  for (std::size_t entry = 0; entry < table().entries().size(); entry += 37) {
    const auto [first, lines] = table().entries()[entry];
    for (int k = 0; k < std::popcount(lines); ++k) {
      const auto words = table().data().subspan((first + std::size_t(k)) * words_per_line, words_per_line);
      ASSERT_TRUE(std::any_of(words.begin(), words.end(), [](std::uint32_t w) { return w != 0; })) << entry;
    }
  }
}

// Larger spheres have no entry, and are exact.
TEST_F(SphereTables, TheFineTableErrsLessAndEndsAtFortyFiveDegrees) {
  EXPECT_GE(fine().entry({0, 0, 1}, 0.7071f, vec3(0.0f)), 0);
  EXPECT_EQ(fine().entry({0, 0, 1}, 0.7072f, vec3(0.0f)), beyond_table);
  double wrong = 0.0, wrong_fine = 0.0;
  for (std::uint32_t k = 0; k < 500; ++k) {
    const SphereSet set{{test::cap_sphere(random_direction(k), 0.02 + 1.0 * double(random_triple(3, k).z))}};
    BitCube exact(32), coarse(32), better(32);
    rasterise_spheres(set, vec3(0.0f), directions_, exact);
    merge_spheres(table(), set, vec3(0.0f), directions_, coarse);
    merge_spheres(fine(), set, vec3(0.0f), directions_, better);
    if (fine().entry(set.spheres[0].centre, set.spheres[0].radius, vec3(0.0f)) == beyond_table)
      EXPECT_EQ(better.words, exact.words);
    for (std::size_t w = 0; w < exact.words.size(); ++w) {
      wrong += std::popcount(exact.words[w] ^ coarse.words[w]);
      wrong_fine += std::popcount(exact.words[w] ^ better.words[w]);
    }
  }
  EXPECT_LT(wrong_fine, 0.6 * wrong);
}

TEST_F(SphereTables, QuantisationIsWithinHalfABinAndATexel) {
  for (std::uint32_t k = 0; k < 5000; ++k) {
    const vec3 v = random_direction(k);
    const double theta = 0.01 + 1.55 * double(random_triple(3, k).z);
    const int entry = table().entry(v, float(std::sin(theta)), vec3(0.0f));
    ASSERT_GE(entry, 0);
    EXPECT_NEAR(std::acos(double(table().cosine(entry % 32))), theta, pi / 128 + 1e-4);
    EXPECT_LT(std::acos(std::min(1.0f, glm::dot(directions_[entry / 32], v))), 2.54 * pi / 180);
  }
}

TEST_F(SphereTables, RatioBinsAreUniformInTheRatio) {
  const SphereTable ratio(SphereTable::published(16, RadiusBins::uniform_ratio));
  for (int k = 0; k < 31; ++k) EXPECT_EQ(ratio.bins().find(float((k + 0.5) * (k + 0.5)) / 1024), k);
  EXPECT_NEAR(ratio.cosine(16), std::sqrt(1 - (16.5 / 32) * (16.5 / 32)), 1e-6);
}

TEST_F(SphereTables, OnlySixteenAndThirtyTwo) {
  EXPECT_NE(test::error_of([] { SphereTable(SphereTable::published(64, RadiusBins::uniform_angle)); }).find("16 or 32"),
            std::string::npos);
}

// Hard case 1: inside, or at the centre.
TEST_F(SphereTables, InsideBlocksEverything) {
  for (const vec3 x : {vec3(0.0f), vec3(0.5f, 0, 0), vec3(0, 1, 0)}) {
    BitCube table_bits(32), exact(32);
    const SphereSet set{{{vec3(0.0f), 1.0f}}};
    merge_spheres(table(), set, x, directions_, table_bits);
    rasterise_spheres(set, x, directions_, exact);
    EXPECT_EQ(table_bits.count(), 6144);
    EXPECT_EQ(exact.count(), 6144);
  }
}

TEST_F(SphereTables, RadiusZeroBlocksNothing) {
  for (const vec3 centre : {vec3(0, 0, 1), vec3(0.0f), directions_[100]}) {
    BitCube bits(32);
    merge_spheres(table(), {{{centre, 0.0f}}}, vec3(0.0f), directions_, bits);
    rasterise_spheres({{{centre, 0.0f}}}, vec3(0.0f), directions_, bits);
    EXPECT_EQ(bits.count(), 0);
  }
}

// Hard case 8: two touching spheres on opposite axes.
TEST_F(SphereTables, TouchingSpheresOnBothSidesBlockTheSphere) {
  BitCube exact(32);
  const float touching = 1.0f - 1e-6f;
  rasterise_spheres({{{{0, 0, 1}, touching}, {{0, 0, -1}, touching}}}, vec3(0.0f), directions_, exact);
  EXPECT_EQ(exact.count(), 6144);
}

// Hard case 9: duplicates and order do not matter.
TEST_F(SphereTables, DuplicatesAndOrderChangeNothing) {
  std::vector<Sphere> spheres;
  for (std::uint32_t k = 0; k < 20; ++k) spheres.push_back(test::cap_sphere(random_direction(k), 0.1 + 0.02 * k));
  BitCube once(32), many(32), exact(32), reversed(32);
  merge_spheres(table(), {spheres}, vec3(0.0f), directions_, once);
  rasterise_spheres({spheres}, vec3(0.0f), directions_, exact);
  rasterise_spheres({{spheres.rbegin(), spheres.rend()}}, vec3(0.0f), directions_, reversed);
  EXPECT_EQ(exact.words, reversed.words);
  SphereSet million;
  while (million.size() < 1000000) million.spheres.push_back(spheres[million.size() * 7 % 20]);
  merge_spheres(table(), million, vec3(0.0f), directions_, many);
  EXPECT_EQ(once.words, many.words);
}

// Hard case 12: of nested caps only the outer counts.
TEST_F(SphereTables, NestedCapsAreTheOuterOne) {
  BitCube outer(32), both(32);
  rasterise_spheres({{test::cap_sphere({1, 2, 3}, 0.5)}}, vec3(0.0f), directions_, outer);
  rasterise_spheres({{test::cap_sphere({1, 2, 3}, 0.2), test::cap_sphere({1, 2, 3}, 0.5)}}, vec3(0.0f), directions_,
                    both);
  EXPECT_EQ(outer.words, both.words);
}

// Hard case 13: caps smaller than a texel are right on average.
TEST_F(SphereTables, TinyCapsAreUnbiasedWhenRasterised) {
  const double theta = 0.5 * pi / 180, exact = 2 * pi * (1 - std::cos(theta));
  double sum = 0.0;
  constexpr int draws = 10000;
  for (std::uint32_t k = 0; k < draws; ++k) {
    BitCube bits(32);
    rasterise_spheres({{test::cap_sphere(random_direction(k), theta)}}, vec3(0.0f), directions_, bits);
    ASSERT_LE(bits.count(), 1);
    for (int w = 0; w < 192; ++w)
      if (bits.words[w]) sum += cube_texel_solid_angle(w * 32 + std::countr_zero(bits.words[w]), 32);
  }
  EXPECT_NEAR(sum / draws / exact, 1.0, 0.1);  // three standard errors: one draw in ten hits a texel
}

// Hard case 15: all 48 symmetries of the cube see equally many texels.
TEST_F(SphereTables, CubeSymmetriesKeepTheCount) {
  for (const vec3 v : {vec3(1, 1, 1.0001f), vec3(1, 0.9999f, 0.1f), vec3(0.3f, 0.5f, 0.9f)})
    for (const double theta : {0.1234, 0.4321, 0.9}) {
      int wanted = -1;
      for (int permutation = 0; permutation < 6; ++permutation)
        for (int signs = 0; signs < 8; ++signs) {
          const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
          vec3 w;
          for (int c = 0; c < 3; ++c) w[c] = v[order[permutation][c]] * (signs >> c & 1 ? -1.0f : 1.0f);
          BitCube bits(32);
          rasterise_spheres({{test::cap_sphere(w, theta)}}, vec3(0.0f), directions_, bits);
          if (wanted < 0) wanted = bits.count();
          EXPECT_EQ(bits.count(), wanted);
        }
    }
}

}  // namespace
}  // namespace penumbra
