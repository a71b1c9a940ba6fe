#include <gtest/gtest.h>

#include "techniques/visibility_filter/filter_width.h"
#include "techniques/visibility_filter/surface_bits.h"
#include "tests/techniques/random_pixels.h"

namespace penumbra::visibility_filter {
namespace {

using test::random_map;

constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(VisibilityFilter, BitsCountWhatRingsCount) {
  std::vector<std::uint8_t> same;
  int masked = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const PixelMap map = random_map(1 + int(seed * 7 % 90), 1 + int(seed * 11 % 50), seed);
    const int r = seed % 4 == 0 ? 31 : int(seed % 13);
    SurfaceBits bits;
    bits.set(map, 0.3f, r);
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x) {
        if (std::isnan(map.depth[std::size_t(y * map.width + x)])) continue;
        find_surface(map, x, y, r, 0.3f, same);
        const Counted rings = count_surface(map, x, y, r, same);
        ASSERT_EQ(bits.count(x, y, r), rings) << seed << ": " << x << ", " << y << " r " << r;
        ASSERT_EQ(bits.borrowed_caster(map.caster, x, y, r), borrowed_caster(map, x, y, r, same))
            << seed << ": " << x << ", " << y;
        if (!bits.is_mixed(x, y)) ASSERT_TRUE(rings.open == 0 || rings.open == rings.all);
        masked += rings.all < (2 * r + 1) * (2 * r + 1);
      }
  }
  EXPECT_GT(masked, 1000);
}

TEST(VisibilityFilter, AMaskThatIsolatesAPixelLeavesItsOwnValue) {  // hard case 33
  PixelMap map;
  map.resize(9, 9);
  std::fill(map.depth.begin(), map.depth.end(), 4.0f);
  std::fill(map.open.begin(), map.open.end(), std::uint8_t(1));
  map.depth[4 * 9 + 4] = 2.0f;
  for (const int own : {0, 1}) {
    map.open[4 * 9 + 4] = std::uint8_t(own);
    SurfaceBits bits;
    bits.set(map, 0.3f, 4);
    EXPECT_EQ(bits.count(4, 4, 4), (Counted{1, own}));
    EXPECT_EQ(bits.count(0, 0, 1), (Counted{4, 4}));
  }
}

TEST(VisibilityFilter, SurfacesAreConnectedByRings) {
  // A wall with a gap far to the right: pixels behind it are near in depth, yet no ring reaches them.
  PixelMap map;
  map.resize(21, 21);
  std::fill(map.depth.begin(), map.depth.end(), 4.0f);
  std::fill(map.open.begin(), map.open.end(), std::uint8_t(1));
  for (int x = 0; x < 21; ++x) map.depth[std::size_t(7 * 21 + x)] = 2.0f;
  for (int i = 0; i < 7 * 21; ++i) map.open[std::size_t(i)] = 0;
  SurfaceBits bits;
  bits.set(map, 0.3f, 5);
  EXPECT_EQ(bits.count(10, 10, 5), (Counted{11 * 8, 11 * 8}));       // rows 8 to 15
  EXPECT_EQ(bits.count_all(10, 10, 5), (Counted{11 * 11, 11 * 9}));  // no mask: it leaks
  EXPECT_EQ(bits.borrowed_caster(map.caster, 10, 10, 5), infinity);
}

TEST(VisibilityFilter, ABoxNeedsNoLinks) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const PixelMap map = random_map(70 + int(seed), 20, seed);
    const int r = 1 + int(seed);
    SurfaceBits with, without;
    with.set(map, 0.3f, r), without.set(map, std::nullopt, r);
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x) {
        ASSERT_EQ(with.is_mixed(x, y), without.is_mixed(x, y));
        ASSERT_EQ(with.count_all(x, y, r), without.count_all(x, y, r));
      }
  }
}

TEST(VisibilityFilter, BitsOfASmallerMapForgetTheLarger) {
  SurfaceBits used;
  used.set(random_map(200, 60, 1), 0.3f, 9);
  for (const auto& [width, height] : {std::pair(200, 60), {130, 40}, {40, 130}, {1, 1}, {0, 0}, {64, 64}}) {
    const PixelMap map = random_map(width, height, 2);
    SurfaceBits fresh;
    fresh.set(map, 0.3f, 9), used.set(map, 0.3f, 9);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) ASSERT_EQ(used.count(x, y, 9), fresh.count(x, y, 9)) << x << ", " << y;
  }
}

TEST(VisibilityFilter, BitsOfWordsAreFound) {
  for (int low = 0; low < 64; ++low)
    for (int high = low; high < 64; ++high) {
      const std::uint64_t word = bit_at(low) | bit_at(high);
      EXPECT_EQ(lowest_bit(word), low);
      EXPECT_EQ(highest_bit(word), high);
      EXPECT_EQ(bits_in(word), low == high ? 1 : 2);
    }
}

TEST(VisibilityFilter, WidthsFollowTheAngles) {
  const float d1 = 1.0f, to_light = 10.0f;
  for (const int most : {1, 2, 20, 21, 63}) {
    const WidthModel model{most, d1, 12.0f};
    int before = 0;
    for (float caster = 1e-6f; caster < to_light; caster *= 1.1f) {
      const int r = filter_radius(model, to_light, caster, 1.0f);
      EXPECT_GE(r, before) << "a caster that recedes makes no shadow harder";
      EXPECT_LE(2 * r + 1, std::max(most, 1));
      before = r;
    }
    EXPECT_EQ(filter_radius(model, to_light, 0.0f, 1.0f), 0);  // contact (hard case 32)
    EXPECT_EQ(filter_radius(model, to_light, infinity, 1.0f) * 2 + 1, most > 1 ? (most - 1) / 2 * 2 + 1 : 1);
    EXPECT_LE(2 * filter_radius(model, to_light, to_light, 1.0f), 11 * most / 12);  // small angles
  }
  // alpha = 2 atan(1/20), beta = 2 atan(1/48): 20 (alpha - beta) / alpha = 11.66 pixels, 5 on either side.
  EXPECT_EQ(filter_radius({20, d1, 12.0f}, to_light, 2.0f, 1.0f), 5);
  // Twice as near to the eye as the widths are meant for: twice as wide, up to the most.
  EXPECT_EQ(filter_radius({20, d1, 12.0f, false, 3.0f}, to_light, 1.0f, 2.0f), 2);  // 3.34 * 1.5 = 5.0
  EXPECT_EQ(filter_radius({20, d1, 12.0f, false, 8.0f}, to_light, 2.0f, 2.0f), 9);
}

TEST(VisibilityFilter, LiteralWidthsRiseAgainTowardsContact) {
  const WidthModel model{20, 1.0f, 12.0f, true};
  const int at_contact = filter_radius(model, 10.0f, 1e-3f, 1.0f),
            where_equal = filter_radius(model, 10.0f, 10.0f / 12.0f, 1.0f);
  EXPECT_EQ(where_equal, 0);
  EXPECT_GE(at_contact, 8);
}

TEST(VisibilityFilter, NonsenseHasNoWidth) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [light, caster, eye] :
       {std::tuple(nan, 1.0f, 1.0f), {1.0f, nan, 1.0f}, {1.0f, 1.0f, nan}, {0.0f, 1.0f, 1.0f}, {1.0f, 1.0f, infinity}})
    EXPECT_EQ(filter_radius({20, 1.0f, 12.0f, false, 1.0f}, light, caster, eye), 0);
  EXPECT_EQ(filter_radius({20, 0.0f, 12.0f}, 1.0f, 1.0f, 1.0f), 0);  // a lamp without size
}

}  // namespace
}  // namespace penumbra::visibility_filter
