// Moments of depth: what any four numbers say about a region, and the table that gives them.
#include "techniques/moment_shadows/moments.h"

#include <tbb/task_arena.h>

#include "tests/techniques/random_map.h"

namespace penumbra::moment_shadows {
namespace {

Moments moments_of(const std::vector<std::pair<double, double>>& depths) {
  Moments b{};
  for (const auto& [share, z] : depths)
    for (int j = 0; j < 4; ++j) b[std::size_t(j)] += share * std::pow(z, j + 1);
  return b;
}

/// Integral of z^(j + 1) from 0 to 1.
const Moments evenly = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5};

TEST(PcssMoments, BiasMixesInEvenlySpreadDepths) {
  const Moments b = moments_of({{0.4, 0.2}, {0.6, 0.9}}), none = biased(b, 0.0), all = biased(b, 1.0),
                quarter = biased(b, 0.25);
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_DOUBLE_EQ(none[j], b[j]) << j;
    EXPECT_DOUBLE_EQ(all[j], evenly[j]) << j;
    EXPECT_DOUBLE_EQ(quarter[j], 0.75 * b[j] + 0.25 * evenly[j]) << j;
  }
}

/// Even depths and z0 in their middle: the three points and weights of Gauss and Legendre.
TEST(PcssMoments, EvenDepthsGiveTheGaussianRule) {
  const ThreeDepths found = three_depths(evenly, 0.5);
  EXPECT_NEAR(found.z1, 0.5 - std::sqrt(0.15), 1e-12);
  EXPECT_NEAR(found.z2, 0.5 + std::sqrt(0.15), 1e-12);
  EXPECT_NEAR(found.weight0, 8.0 / 18.0, 1e-12);
  EXPECT_NEAR(found.weight1, 5.0 / 18.0, 1e-12);
  const MomentBlockers nearer = blockers_of_moments(evenly, 0.5), all = blockers_of_moments(evenly, 1.2);
  EXPECT_NEAR(nearer.share, 5.0 / 18.0, 1e-12);
  EXPECT_NEAR(nearer.mean, 0.5 - std::sqrt(0.15), 1e-12);
  const double weight0 = three_depths(evenly, 1.2).weight0;  // behind all: what is not z0 itself, and its mean
  EXPECT_NEAR(all.share, 1.0 - weight0, 1e-12);
  EXPECT_NEAR(all.mean, (0.5 - weight0 * 1.2) / (1.0 - weight0), 1e-12);
}

/// Any three depths that the equations give have the moments they were given.
TEST(PcssMoments, ThreeDepthsHaveTheMoments) {
  const Moments b = moments_of({{0.2, 0.1}, {0.3, 0.35}, {0.1, 0.5}, {0.4, 0.8}});
  for (const double z0 : {0.05, 0.3, 0.45, 0.7, 0.95}) {
    const ThreeDepths t = three_depths(b, z0);
    EXPECT_LE(t.z1, t.z2);
    const Moments again = moments_of({{t.weight0, z0}, {t.weight1, t.z1}, {1 - t.weight0 - t.weight1, t.z2}});
    for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(again[j], b[j], 1e-9) << z0 << " " << j;
  }
}

TEST(PcssMoments, DepthsRunFromTheNearestOccluderToFourFifthsAtTheFarthestReceiver) {
  const ShadowMap map = random_map(8);  // near is 1
  MomentTable table;
  table.build(map, 3.0f);
  EXPECT_NEAR(table.normalised(1.0f), 0.0, 1e-12);
  EXPECT_NEAR(table.normalised(3.0f), 0.8, 1e-12);
  EXPECT_NEAR(table.depth(table.normalised(2.5f)), 2.5f, 1e-6f);
}

TEST(PcssMoments, TwoDepthsAreFoundExactly) {
  for (const double share : {0.1, 0.5, 0.9})
    for (const double z0 : {0.4, 0.6, 0.85}) {
      const MomentBlockers found = blockers_of_moments(biased(moments_of({{share, 0.3}, {1 - share, 1.0}}), 1e-9), z0);
      EXPECT_NEAR(found.share, share, 1e-4);
      EXPECT_NEAR(found.mean, 0.3, 1e-4);
    }
  EXPECT_LT(blockers_of_moments(biased(moments_of({{0.5, 0.3}, {0.5, 1.0}}), 1e-9), 0.2).share, 1e-4) << "in front";
}

TEST(PcssMoments, ABoundFromBelowForMoreDepths) {
  std::mt19937 random(23);
  for (int k = 0; k < 500; ++k) {
    std::vector<std::pair<double, double>> depths;
    for (int j = 0; j < 8; ++j) depths.emplace_back(0.125, double(unit(random)));
    const double z0 = double(unit(random));
    double nearer = 0.0;
    for (const auto& [share, z] : depths) nearer += z < z0 ? share : 0.0;
    const double found = blockers_of_moments(biased(moments_of(depths), 1e-9), z0).share;
    EXPECT_GE(found, 0.0);
    EXPECT_LE(found, nearer + 1e-5);
  }
}

TEST(PcssMoments, TableGivesMeansOfRectangles) {
  const ShadowMap map = random_map(20);
  for (const int threads : {1, 2}) {
    MomentTable table;
    tbb::task_arena(threads).execute([&] { table.build(map, 4.0f); });
    for (const Texels& t : {Texels{0, 20, 0, 20}, Texels{3, 4, 5, 6}, Texels{-5, 8, 10, 30}, Texels{50, 60, 0, 2}}) {
      Moments sum{};
      for (int y = t.top; y < t.bottom; ++y)
        for (int x = t.left; x < t.right; ++x) {
          const bool inside = x >= 0 && y >= 0 && x < 20 && y < 20;
          const double z = inside ? std::clamp(table.normalised(map.at(x, y)), 0.0, 1.0) : 1.0;
          for (int j = 0; j < 4; ++j) sum[std::size_t(j)] += std::pow(z, j + 1) / t.count();
        }
      for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(table.mean(t)[j], sum[j], 1e-12);
    }
  }
}

}  // namespace
}  // namespace penumbra::moment_shadows
