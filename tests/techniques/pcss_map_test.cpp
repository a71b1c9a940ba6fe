// Parts of the shadow-map family against plain definitions: regions, multi-scale maps, quadtrees, samples, links, blur.
#include <tbb/task_arena.h>

#include <set>

#include "techniques/pcss/kernel.h"
#include "tests/techniques/random_map.h"

namespace penumbra::pcss {
namespace {

// --- regions ---------------------------------------------------------------------------------------------------------

TEST(PcssRegion, TexelsAreThoseWhoseCentresLieInside) {
  std::mt19937 random(3);
  for (int k = 0; k < 1000; ++k) {
    const float x = 40.0f * unit(random) - 5.0f, width = 20.0f * unit(random);
    int first, last;
    texel_range(x, width, first, last);
    ASSERT_LT(first, last);
    int inside = 0;
    for (int i = -50; i < 100; ++i) inside += std::abs(float(i) + 0.5f - x) <= 0.5f * width;
    if (inside > 0) EXPECT_EQ(last - first, inside);
    else EXPECT_EQ(first, int(std::floor(x)));
  }
}

/// Steps 1 to 7 of Zhu et al. 2019, section 2.2, as they are written.
Square literal_snap(float x, float y, float s, int e) {
  int l = int(std::floor(x - s / 2)), r = int(std::ceil(x + s / 2));
  int t = int(std::floor(y - s / 2)), b = int(std::ceil(y + s / 2));
  l = std::max(l, 0), r = std::min(r, e - 1), t = std::max(t, 0), b = std::min(b, e - 1);
  if (r < l || b < t) return {};
  const auto resized = [](int w) {
    std::string bits;
    for (int k = w; k > 0; k /= 2) bits.insert(bits.begin(), char('0' + k % 2));
    if (w == 1 << (bits.size() - 1)) return w;
    return bits[1] == '1' ? 1 << bits.size() : 1 << (bits.size() - 1);
  };
  const int w = resized(r - l + 1), h = resized(b - t + 1);
  const int edge = w == h ? w : std::min(2 * std::min(w, h), e);
  if (l + edge - 1 >= e) l = e - edge;
  if (t + edge - 1 >= e) t = e - edge;
  return {l, t, int(std::log2(edge))};
}

TEST(PcssRegion, SnappingFollowsThePaper) {
  std::mt19937 random(5);
  for (const int edge : {1, 2, 16, 128})
    for (int k = 0; k < 5000; ++k) {
      const float x = float(edge) * (1.4f * unit(random) - 0.2f), y = float(edge) * (1.4f * unit(random) - 0.2f);
      const float s = 0.7f * float(edge) * unit(random);
      const Square ours = snap(x, y, s, edge, largest_level(edge), {});
      ASSERT_EQ(ours, literal_snap(x, y, s, edge)) << x << " " << y << " " << s << " of " << edge;
      if (ours.level >= 0) {
        EXPECT_GE(std::min(ours.left, ours.top), 0);
        EXPECT_LE(std::max(ours.left, ours.top) + ours.edge(), edge);
      }
    }
}

TEST(PcssRegion, OffTheMapThereIsNoneAndLargerThanTheMapItIsTheMap) {
  EXPECT_EQ(snap(-50.0f, 10.0f, 8.0f, 64, 6, {}).level, -1);
  EXPECT_EQ(snap(10.0f, 80.0f, 8.0f, 64, 6, {}).level, -1);
  EXPECT_EQ(snap(30.0f, 30.0f, 1000.0f, 64, 6, {}), (Square{0, 0, 6}));
  EXPECT_EQ(snap(30.0f, 30.0f, 1000.0f, 100, 6, {}).level, 6) << "not a power of two: the largest that fits";
}

TEST(PcssRegion, ReadingsDifferAsTheySay) {
  Snapping exclusive;
  exclusive.inclusive = false;
  EXPECT_EQ(snap(8.0f, 8.0f, 2.0f, 64, 6, {}).edge(), 4) << "7, 8 and 9: three texels, up to four";
  EXPECT_EQ(snap(8.0f, 8.0f, 2.0f, 64, 6, exclusive).edge(), 2);
  Snapping up;
  up.size = Snapping::Size::up;
  up.centred = true;
  std::mt19937 random(7);
  for (int k = 0; k < 1000; ++k) {  // rounding up about the centre covers the region
    const float x = 40.0f + 40.0f * unit(random), s = 1.0f + 30.0f * unit(random);
    const Square square = snap(x, x, s, 128, 7, up);
    EXPECT_LE(float(square.left), x - 0.5f * s + 1.0f);
    EXPECT_GE(float(square.left + square.edge()), x + 0.5f * s - 1.0f);
  }
}

// --- multi-scale maps and quadtrees ----------------------------------------------------------------------------------

TEST(PcssMultiScaleMap, EverySquareKnowsItsTexels) {
  for (const int edge : {1, 5, 16, 33})
    for (const LevelLayout layout : {LevelLayout::full, LevelLayout::reduced}) {
      const ShadowMap map = random_map(edge);
      MultiScaleMap levels;
      levels.build(map, layout, 99);
      ASSERT_EQ(levels.largest(), largest_level(edge));
      for (int level = 0; level <= levels.largest(); ++level) {
        const int stride = levels.stride(level);
        EXPECT_EQ(stride, layout == LevelLayout::full ? edge : edge - (1 << level) + 1);
        for (int y = 0; y < stride; ++y)
          for (int x = 0; x < stride; ++x) {
            float low = INFINITY, high = -INFINITY;
            double sum = 0.0, count = 0.0;
            for (int v = y; v < std::min(edge, y + (1 << level)); ++v)
              for (int u = x; u < std::min(edge, x + (1 << level)); ++u) {
                low = std::min(low, map.at(u, v)), high = std::max(high, map.at(u, v));
                sum += double(map.at(u, v)), count += 1.0;
              }
            const Square square{x, y, level};
            ASSERT_EQ(levels.range(square).low, low);
            ASSERT_EQ(levels.range(square).high, high);
            if (std::isfinite(sum)) ASSERT_NEAR(levels.mean(square), sum / count, 1e-5);
          }
      }
    }
}

TEST(PcssMultiScaleMap, NeededLevelsHoldEveryRegion) {
  std::mt19937 random(29);
  for (const int edge : {5, 64, 100})
    for (int k = 0; k < 4000; ++k) {
      const float widest = float(edge) * unit(random) * unit(random), width = widest * unit(random);
      Snapping how;
      how.inclusive = k % 2 == 0;
      how.size = k % 4 < 2 ? Snapping::Size::nearest : Snapping::Size::up;
      const Square square =
          snap(float(edge) * unit(random), float(edge) * unit(random), width, edge, largest_level(edge), how);
      EXPECT_LE(square.level, needed_level(widest, edge)) << width << " of " << widest << " on " << edge;
    }
}

TEST(PcssMultiScaleMap, OneThreadAndManyAgreeAndLevelsCanBeFew) {
  const ShadowMap map = random_map(64);
  MultiScaleMap a, b;
  a.build(map, LevelLayout::reduced, 6);
  tbb::task_arena(1).execute([&] { b.build(map, LevelLayout::reduced, 3); });
  EXPECT_EQ(b.largest(), 3);
  EXPECT_LT(b.bytes(), a.bytes());
  for (int x = 0; x < 50; ++x) {
    const Square square{x, 50 - x, 3};
    EXPECT_EQ(a.range(square).low, b.range(square).low);
    EXPECT_EQ(a.mean(square), b.mean(square));
  }
}

TEST(PcssQuadtree, DownToTexelsItCountsExactly) {
  const ShadowMap map = random_map(64);
  MultiScaleMap levels;
  levels.build(map, LevelLayout::reduced, 6);
  const LeafSamples samples(make_sample_image(), map);
  std::mt19937 random(11);
  for (int k = 0; k < 300; ++k) {
    const int level = int(random() % 6);
    const Square square{int(random() % unsigned(65 - (1 << level))), int(random() % unsigned(65 - (1 << level))),
                        level};
    const float d = 1.0f + 2.0f * unit(random);
    const Texels texels{square.left, square.left + square.edge(), square.top, square.top + square.edge()};
    const Blockers exact = blockers_of_texels(map, texels, d);
    Blockers found;
    traverse<true>(levels, square, 0, d, nearest_leaf, found);
    EXPECT_EQ(found.count, exact.count);
    EXPECT_NEAR(found.depth_sum, exact.depth_sum, 1e-4f * exact.depth_sum);
    const Blockers vector = simd::blockers_of_texels(map, texels, d);
    EXPECT_EQ(vector.count, exact.count);
    EXPECT_NEAR(vector.depth_sum, exact.depth_sum, 1e-5f * exact.depth_sum);
  }
}

TEST(PcssQuadtree, AMillionTexelsKeepTheirMean) {
  ShadowMap map;
  map.view.resolution = 1024;
  map.depth.assign(map.index(0, 1024), 1.2345678f);
  const Texels all{0, 1024, 0, 1024};
  for (const Blockers& found : {blockers_of_texels(map, all, 2.0f), simd::blockers_of_texels(map, all, 2.0f)}) {
    EXPECT_EQ(found.count, 1048576.0f);
    EXPECT_NEAR(found.mean(), 1.2345678f, 5e-6f);
  }
}

TEST(PcssQuadtree, VectorisedEqualsRecursive) {
  const ShadowMap map = random_map(128);
  MultiScaleMap levels;
  const LeafSamples samples(make_sample_image(), map);
  std::mt19937 random(13);
  for (const LevelLayout layout : {LevelLayout::full, LevelLayout::reduced}) {
    levels.build(map, layout, 7);
    for (int k = 0; k < 2000; ++k) {
      const int level = int(random() % 8), depth = int(random() % 8), leaf_level = std::max(0, level - depth);
      const unsigned room = unsigned(129 - (1 << level));
      const Square square{int(random() % room), int(random() % room), level};
      const float d = 1.0f + 2.0f * unit(random);
      for (const Sum how : {Sum::nearest, Sum::sampled}) {
        Blockers recursive;
        if (how == Sum::nearest) traverse<true>(levels, square, leaf_level, d, nearest_leaf, recursive);
        else
          traverse<true>(
              levels, square, leaf_level, d,
              [&](const Square& leaf, const DepthRange&) { return sampled_leaf(map, samples, leaf, d); }, recursive);
        const Blockers vector = simd::blockers_of_square(map, levels, samples, square, depth, d, how, true);
        ASSERT_EQ(vector.count, recursive.count) << "level " << level << " depth " << depth;
        ASSERT_NEAR(vector.depth_sum, recursive.depth_sum, 1e-5f * recursive.depth_sum);
        ASSERT_EQ(simd::blockers_of_square(map, levels, samples, square, depth, d, how, false).count, recursive.count);
      }
    }
  }
}

TEST(PcssQuadtree, APlaneAtTheReceiversDepthDoesNotBlock) {
  ShadowMap map = random_map(16);
  std::fill(map.depth.begin(), map.depth.end(), 2.0f);
  MultiScaleMap levels;
  levels.build(map, LevelLayout::reduced, 4);
  const LeafSamples samples(make_sample_image(), map);
  Blockers found;
  traverse<true>(levels, {0, 0, 4}, 1, 2.0f, nearest_leaf, found);
  EXPECT_EQ(found.count, 0.0f);
  EXPECT_EQ(found.mean(), 0.0f) << "no blocker, no 0 / 0";
  EXPECT_EQ(simd::blockers_of_square(map, levels, samples, {0, 0, 4}, 3, 2.0f, Sum::sampled, true).count, 0.0f);
  EXPECT_EQ(blockers_of_texels(map, {0, 16, 0, 16}, 2.0f).count, 0.0f);
}

// --- samples ---------------------------------------------------------------------------------------------------------

TEST(PcssSamples, MultiJitteredPointsFillCellsRowsAndColumns) {
  for (const int q : {1, 2, 4, 7}) {
    std::set<int> cells, rows, columns;
    for (const vec2& p : multi_jittered(q, 42)) {
      EXPECT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f);
      cells.insert(int(p.y * float(q)) * q + int(p.x * float(q)));
      rows.insert(int(p.y * float(q * q)));
      columns.insert(int(p.x * float(q * q)));
    }
    for (const auto* seen : {&cells, &rows, &columns}) EXPECT_EQ(seen->size(), std::size_t(q * q)) << q;
  }
}

TEST(PcssSamples, ImageHasThePapersColumns) {
  const int expected[][3] = {{1, 0, 1}, {2, 0, 1}, {4, 1, 4}, {8, 5, 16}, {64, 5, 16}};
  for (const auto& [edge, first, count] : expected) {
    EXPECT_EQ(SampleImage::first(edge), first);
    EXPECT_EQ(SampleImage::count(edge), count);
  }
  const SampleImage image = make_sample_image();
  std::set<float> first;
  for (const auto& variant : image.position) first.insert(variant[0].x);
  EXPECT_EQ(first.size(), 8u) << "eight different variants";
}

/// A leaf's samples are one in each cell of it: 1, 2 x 2 or 4 x 4.
TEST(PcssSamples, LeavesOfEverySizeHaveOneInEachCell) {
  const ShadowMap map = random_map(64);
  const LeafSamples samples(make_sample_image(), map);
  for (int level = 0; level <= 6; ++level)
    for (int variant = 0; variant < SampleImage::variants; ++variant) {
      const int edge = 1 << level, count = SampleImage::count(edge), across = int(std::lround(std::sqrt(count)));
      std::set<int> cells;
      for (int k = 0; k < count; ++k) {
        const int offset = samples.of(level, variant)[k], x = offset % map.stride(), y = offset / map.stride();
        ASSERT_TRUE(x < edge && y < edge);
        cells.insert(y * across / edge * across + x * across / edge);
      }
      EXPECT_EQ(int(cells.size()), count) << "level " << level << " variant " << variant;
    }
}

TEST(PcssSamples, PatternsLieInTheirShapesAndSpread) {
  for (const auto& points : {poisson_disc(32), vogel_disc(32)}) {
    dvec3 mean(0.0);
    for (const vec2& p : points) {
      EXPECT_LE(glm::length(p), 1.0f);
      mean += dvec3(p.x, p.y, double(glm::dot(p, p))) / 32.0;
    }
    EXPECT_LT(std::hypot(mean.x, mean.y), 0.08);
    EXPECT_NEAR(mean.z, 0.5, 0.08) << "mean of r^2 over the disc";
  }
  for (const vec2& p : lattice_square(32)) EXPECT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
}

// --- links -----------------------------------------------------------------------------------------------------------

Tile flat_tile(int columns, int rows) {
  Tile tile;
  tile.place(0, 0, columns, rows);
  for (int k = 0; k < tile.size(); ++k) {
    tile.x[k] = 500.0f + float(k % columns), tile.y[k] = 500.0f, tile.depth[k] = 3.0f, tile.width[k] = 32.0f;
    tile.representative[k] = k;
    tile.square[k] = {490, 490, 5};
  }
  return tile;
}

TEST(PcssReuse, ZeroAndZeroAreAlikeAndTheLargerDivides) {
  EXPECT_TRUE(alike(0.0f, 0.0f, 0.0f));
  EXPECT_FALSE(alike(0.0f, 1.0f, 0.5f));
  EXPECT_TRUE(alike(9.0f, 10.0f, 0.1f)) << "1 / 10, not 1 / 9";
  EXPECT_FALSE(alike(8.9f, 10.0f, 0.1f));
}

TEST(PcssReuse, GroupsStayInTheirAreas) {
  Tile tile = flat_tile(12, 8);
  Reuse how;
  how.area = 4;
  link(how, tile);
  for (int k = 0; k < tile.size(); ++k) {
    const int first = k / 12 / 4 * 4 * 12 + k % 12 / 4 * 4;
    EXPECT_EQ(tile.representative[k], first) << "all are alike: the area's first stands for it";
  }
  tile = flat_tile(12, 8);
  how.literal = true;
  link(how, tile);
  int alone = 0;
  for (int k = 0; k < tile.size(); ++k) {
    alone += tile.representative[k] == k;
    if (k % 12 % 4 == 0 || k / 12 % 4 == 0) EXPECT_EQ(tile.representative[k], k);
  }
  EXPECT_EQ(alone, 12 * 8 * 7 / 16) << "7 of 16 stay alone (the paper's sentence)";
}

TEST(PcssReuse, AreasOfOneAndDifferencesShareNothing) {
  Tile tile = flat_tile(8, 4);
  Reuse how;
  link(how, tile);
  for (int k = 0; k < tile.size(); ++k) EXPECT_EQ(tile.representative[k], k);
  how.area = 4;
  for (int k = 0; k < tile.size(); ++k) tile.square[k].level = k % 2 ? 5 : 4, tile.representative[k] = k;
  tile.representative[0] = -1;
  link(how, tile);
  EXPECT_EQ(tile.representative[0], -1) << "lit stays lit";
  for (int k = 1; k < tile.size(); ++k) EXPECT_EQ(tile.representative[k] % 2, k % 2) << "sizes differ, sigma is 0";
}

TEST(PcssReuse, TheMeshSharesNothingWithWhatLiesBesideIt) {
  Tile tile = flat_tile(8, 4);
  for (int k = 0; k < tile.size(); ++k) tile.rise[k] = k % 8 < 2 ? 0.001f : 0.0f;
  Reuse how;
  how.area = 4;
  link(how, tile);
  for (int k = 0; k < tile.size(); ++k) EXPECT_EQ(tile.representative[k] % 8, k % 8 < 2 ? 0 : k % 8 < 4 ? 2 : 4);
}

TEST(PcssReuse, DistanceCanBeRelativeToTheSize) {
  Reuse how;
  const RegionKey a{1000, 1000, 8, 3}, b{1050, 1000, 8, 3};
  EXPECT_TRUE(alike(a, b, how)) << "50 of 1050 texels";
  how.place_by_size = true;
  EXPECT_FALSE(alike(a, b, how)) << "50 texels of regions of 8";
}

// --- blur ------------------------------------------------------------------------------------------------------------

TEST(PcssBlur, KeepsConstantsAndSkipsWhatShowsNothing) {
  for (const auto& [width, height] : {std::pair(40, 21), {3, 2}, {1, 1}, {33, 1}}) {
    MaskedImage image{width, height, {}, {}}, between = image;
    for (int i = 0; i < width * height; ++i) {
      image.weight.push_back(i % 7 == 3 ? 0.0f : 1.0f);
      image.value.push_back(i % 7 == 3 ? 99.0f : 0.25f);
    }
    between.value.resize(image.value.size()), between.weight.resize(image.value.size());
    std::vector<float> out(image.value.size());
    const auto kernel = gaussian(3);
    blur_rows(image, kernel, 0, height, between);
    blur_columns(between, kernel, 0, height, out.data());
    for (std::size_t i = 0; i < out.size(); ++i) EXPECT_NEAR(out[i], 0.25f, 1e-6f) << i;
  }
}

TEST(PcssBlur, VectorisedIsTheSameToTheBit) {
  const auto kernel = gaussian(3);
  EXPECT_NEAR(kernel[0] + 2.0f * (kernel[1] + kernel[2] + kernel[3]), 1.0f, 1e-6f);
  EXPECT_NEAR(kernel[1] / kernel[0], std::exp(-0.5 / 2.25), 1e-6) << "sigma 1.5";
  for (const int width : {1, 5, 16, 67}) {
    MaskedImage image{width, 9, {}, {}};
    std::mt19937 random(19);
    for (int i = 0; i < width * 9; ++i)
      image.value.push_back(unit(random)), image.weight.push_back(i % 5 ? 1.0f : 0.0f);
    MaskedImage a = image, b = image;
    std::vector<float> x(image.value.size()), y(x);
    blur_rows(image, kernel, 0, 9, a);
    blur_columns(a, kernel, 0, 9, x.data());
    simd::blur_rows(image, kernel, 0, 9, b);
    simd::blur_columns(b, kernel, 0, 9, y.data());
    EXPECT_EQ(x, y) << width;
  }
}

}  // namespace
}  // namespace penumbra::pcss
