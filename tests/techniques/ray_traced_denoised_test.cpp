#include <gtest/gtest.h>

#include <random>
#include <set>

#include "scenes/scene_file.h"
#include "techniques/bases/light_sampling.h"
#include "techniques/ray_traced_denoised/light_rays.h"
#include "techniques/ray_traced_denoised/pattern.h"
#include "techniques/ray_traced_denoised/ratio_filter.h"
#include "techniques/ray_traced_denoised/tiles.h"
#include "tests/techniques/lamp_scenes.h"

namespace penumbra::ray_traced_denoised {
namespace {

using test::backends;

const std::string technique = "ray-traced-denoised";

/// width x height receivers of a horizontal plane about the origin, `spacing` apart.
Receivers plane_grid(int width, int height, float spacing, float y = 0.0f) {
  std::vector<vec3> points;
  points.reserve(std::size_t(width) * std::size_t(height));
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      points.emplace_back((float(column) + 0.5f - 0.5f * float(width)) * spacing, y,
                          (float(row) + 0.5f - 0.5f * float(height)) * spacing);
  Receivers r = test::receivers_at(points);
  r.width = width, r.height = height;
  return r;
}

/// Relative RMSE of visibility against the half-plane's ramp of tests/techniques/lamp_scenes.h.
double ramp_error(const std::string& backend, const std::vector<std::string>& parameters) {
  const Receivers grid = plane_grid(96, 24, 0.005f);  // the penumbra is 1/3 m wide, the grid 0.48 m
  const Scene scene = test::lamp_scene(test::plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 1.0f), grid);
  const std::vector<double> found = test::visibility(technique, backend, parameters, scene);
  double squares = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double truth = test::square_ramp(3.0 * double(grid.position[i].x), 1.0);
    squares += (found[i] - truth) * (found[i] - truth), energy += truth * truth;
  }
  return std::sqrt(squares / energy);
}

// --- the points ------------------------------------------------------------------------------------------------------

TEST(RayTracedDenoised, ABlocksPointsAreANet) {
  for (const int rays : {1, 4, 16}) {
    const std::vector<vec2> points = pattern_points(rays, 7);
    const int count = pattern_size * rays;
    ASSERT_EQ(int(points.size()), count);
    for (int columns = 1; columns <= count; columns *= 2) {  // one point in each of `count` boxes, of every shape
      std::set<std::pair<int, int>> boxes;
      for (const vec2 p : points) boxes.emplace(int(p.x * float(columns)), int(p.y * float(count / columns)));
      EXPECT_EQ(int(boxes.size()), count) << rays << " rays, " << columns << " columns";
    }
  }
}

TEST(RayTracedDenoised, EveryWindowAsksEveryPartOfTheLight) {
  const int rays = 4;
  const std::vector<vec2> points = pattern_points(rays, 3);
  for (const int edge : {1, 2, 4})
    for (int y0 = 0; y0 < 9; ++y0)
      for (int x0 = 0; x0 < 9; ++x0) {
        const int parts = edge * edge * rays;
        std::set<int> found;
        for (int y = y0; y < y0 + edge; ++y)
          for (int x = x0; x < x0 + edge; ++x)
            for (int j = 0; j < rays; ++j)
              found.insert(int(points[std::size_t(place_in_pattern(x, y) * rays + j)].x * float(parts)));
        ASSERT_EQ(int(found.size()), parts) << edge << " pixels from " << x0 << ", " << y0;
      }
}

TEST(RayTracedDenoised, PlacesFollowAZCurve) {
  EXPECT_EQ(place_in_pattern(1, 0), 1);
  EXPECT_EQ(place_in_pattern(0, 1), 2);
  EXPECT_EQ(place_in_pattern(2, 5), 4 + 2 + 32);
  EXPECT_EQ(place_in_pattern(8 + 3, 16 + 1), place_in_pattern(3, 1));
}

// --- surfaces --------------------------------------------------------------------------------------------------------

TEST(RayTracedDenoised, LinksEndAtStepsCreasesAndHoles) {
  Receivers r = plane_grid(7, 3, 0.1f);
  r.position[7 + 3].y += 0.5f;                           // a step
  r.normal[5] = glm::normalize(vec3(1.0f, 1.0f, 0.0f));  // a crease
  r.normal[2 * 7 + 1] = vec3(0.0f);                      // nothing is seen
  SurfaceMap map;
  find_surfaces(r, map);
  const auto row = [&](const std::vector<std::uint8_t>& run, int y) {
    return std::vector<int>(run.begin() + y * 7, run.begin() + (y + 1) * 7);
  };
  EXPECT_EQ(row(map.right, 0), (std::vector<int>{4, 3, 2, 1, 0, 0, 0}));
  EXPECT_EQ(row(map.left, 0), (std::vector<int>{0, 1, 2, 3, 4, 0, 0}));
  EXPECT_EQ(row(map.right, 1), (std::vector<int>{2, 1, 0, 0, 2, 1, 0}));
  EXPECT_EQ(row(map.left, 2), (std::vector<int>{0, 0, 0, 1, 2, 3, 4}));
  EXPECT_EQ(row(map.down, 0), (std::vector<int>{2, 1, 2, 0, 2, 0, 2}));
  EXPECT_EQ(row(map.up, 2), (std::vector<int>{2, 0, 2, 0, 2, 1, 2}));
  EXPECT_FLOAT_EQ(map.across[0], 10.0f);
  EXPECT_EQ(map.across[5], 0.0f) << "without a neighbour no filter";
}

TEST(RayTracedDenoised, SurfacesKnowNoUnit) {
  for (const float scale : {1e-6f, 1.0f, 1e6f}) {
    Receivers r = plane_grid(5, 5, 0.1f * scale);
    r.position[12].y += 0.04f * scale;
    EXPECT_TRUE(linked(r, 0, 1));
    EXPECT_FALSE(linked(r, 11, 12));
  }
}

// --- the filter ------------------------------------------------------------------------------------------------------

SurfaceMap flat_map(int width, int height) {
  SurfaceMap map;
  find_surfaces(plane_grid(width, height, 0.5f), map);
  return map;
}

/// Both passes of an image, by functions of either backend.
template <class Rows, class Columns>
Plane filtered(const SurfaceMap& map, const Sums& in, const Plane& extent, float most, Rows rows, Columns columns) {
  Sums means;
  Plane share;
  const auto n = std::size_t(map.width) * std::size_t(map.height);
  means.seen.resize(n), means.all.resize(n), share.resize(n);
  for (int y = 0; y < map.height; ++y) rows(map, extent, most, in, y, means);
  for (int y = 0; y < map.height; ++y) columns(map, extent, most, means, y, share);
  return share;
}

Sums make_sums(std::size_t n, float seen, float all) {
  Sums sums;
  sums.seen.resize(n), sums.all.resize(n);
  for (std::size_t i = 0; i < n; ++i) sums.seen[i] = seen, sums.all[i] = all;
  return sums;
}

Plane even_plane(std::size_t n, float value) {
  Plane plane;
  plane.resize(n);
  for (std::size_t i = 0; i < n; ++i) plane[i] = value;
  return plane;
}

TEST(RayTracedDenoised, BoxesOfFourWeighEveryPlaceAlike) {
  // Full width 2 m at 2 pixels per metre: 4 pixels, of which the two at the ends count half.
  const float half = half_width(2.0f, 2.0f, 8.0f);
  EXPECT_EQ(half, 1.5f);
  EXPECT_EQ(box_weight(half, 0), 1.0f);
  EXPECT_EQ(box_weight(half, 1), 1.0f);
  EXPECT_EQ(box_weight(half, 2), 0.5f);
  EXPECT_EQ(box_weight(half, 3), 0.0f);
  EXPECT_EQ(half_width(2.0f, 2.0f, 3.0f), 1.0f) << "no wider than the widest";
  EXPECT_EQ(half_width(0.4f, 2.0f, 8.0f), 0.0f) << "less than a pixel is a pixel";
}

TEST(RayTracedDenoised, APointBecomesItsBox) {
  const int width = 21, height = 15;
  const SurfaceMap map = flat_map(width, height);
  const std::size_t n = std::size_t(width) * std::size_t(height);
  Sums sums = make_sums(n, 0.0f, 1.0f);
  sums.seen[std::size_t(7 * width + 10)] = 1.0f;
  const Plane share = filtered(map, sums, even_plane(n, 2.0f), 64.0f, filter_row, filter_columns);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto weight = [](int k) { return k > 2 ? 0.0f : k == 2 ? 0.5f : 1.0f; };
      EXPECT_NEAR(share[std::size_t(y * width + x)], weight(std::abs(x - 10)) * weight(std::abs(y - 7)) / 16.0f, 1e-6f)
          << x << ", " << y;
    }
}

TEST(RayTracedDenoised, EqualValuesStay) {
  const SurfaceMap map = flat_map(33, 19);
  const std::size_t n = 33 * 19;
  for (const float extent : {0.0f, 1.7f, 4.0f, 1e30f}) {
    const Plane share =
        filtered(map, make_sums(n, 0.3f, 0.7f), even_plane(n, extent), 40.0f, filter_row, filter_columns);
    const Plane vectors =
        filtered(map, make_sums(n, 0.3f, 0.7f), even_plane(n, extent), 40.0f, simd::filter_row, simd::filter_columns);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_NEAR(share[i], 3.0f / 7.0f, 1e-6f);
      ASSERT_NEAR(vectors[i], 3.0f / 7.0f, 1e-6f);
    }
  }
}

TEST(RayTracedDenoised, BothSumsAreFilteredAlike) {
  // U varies, as it does towards a lamp that is near; where nothing is blocked the share is 1 to the bit.
  const SurfaceMap map = flat_map(24, 24);
  const std::size_t n = 24 * 24;
  Sums sums = make_sums(n, 0.0f, 0.0f);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < n; ++i) sums.seen[i] = sums.all[i] = float(random() % 1000);
  const Plane share = filtered(map, sums, even_plane(n, 3.0f), 64.0f, filter_row, filter_columns);
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(share[i], 1.0f);
}

TEST(RayTracedDenoised, VectorsFilterAsTheEquationSays) {
  std::mt19937 random(11);
  const auto number = [&] { return float(random() % 1024) / 1024.0f; };
  for (const int width : {1, 15, 17, 64})
    for (const int height : {2, 9, 33}) {
      Receivers r = plane_grid(width, height, 0.5f);
      for (int i = 0; i < r.size(); ++i) {
        if (random() % 16 == 0) r.position[i].y += 3.0f;
        if (random() % 16 == 0) r.normal[i] = vec3(0.0f);
      }
      SurfaceMap map;
      find_surfaces(r, map);
      const auto n = std::size_t(r.size());
      Sums sums = make_sums(n, 0.0f, 0.0f);
      Plane extent = even_plane(n, 0.0f);
      for (std::size_t i = 0; i < n; ++i) {
        sums.all[i] = random() % 8 == 0 ? 0.0f : number();
        sums.seen[i] = number() * sums.all[i], extent[i] = 20.0f * number();
      }
      const Plane scalar = filtered(map, sums, extent, 24.0f, filter_row, filter_columns);
      const Plane vectors = filtered(map, sums, extent, 24.0f, simd::filter_row, simd::filter_columns);
      for (std::size_t i = 0; i < n; ++i) ASSERT_NEAR(scalar[i], vectors[i], 1e-6f) << width << " x " << height;
    }
}

TEST(RayTracedDenoised, TilesSpreadTheirCasters) {
  TileMap tiles;
  tiles.resize(20, 12);  // 5 x 3
  std::fill(tiles.lit.begin(), tiles.lit.end(), std::uint8_t(1));
  tiles.dark[6] = tiles.dark[8] = 1;  // (1, 1) and (3, 1)
  tiles.penumbra[6] = 2.0f, tiles.penumbra[8] = 1.0f;
  EXPECT_EQ(spread(tiles, 1), (std::vector<float>{2, 2, 1, 1, 1, 2, 2, 1, 1, 1, 2, 2, 1, 1, 1}));
  EXPECT_EQ(spread(tiles, 0), (std::vector<float>{0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 0, 0, 0, 0, 0}));
  TileMap lost = tiles;  // rays are blocked, but what they hit is not found
  lost.penumbra[6] = lost.penumbra[8] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(spread(lost, 4), std::vector<float>(15, 0.0f));
  std::fill(tiles.lit.begin(), tiles.lit.end(), std::uint8_t(0));
  EXPECT_EQ(spread(tiles, 4), std::vector<float>(15, 0.0f)) << "all dark: nothing to filter";
}

TEST(RayTracedDenoised, PenumbraeAreSimilarTriangles) {
  const Receivers r = plane_grid(2, 2, 0.1f);
  const LightRays lamp(make_rectangle({0, 4, 0}, {1, 0, 0}, {0, 0, 3}, vec3(1.0f)), r, 1, 1);
  EXPECT_FLOAT_EQ(lamp.penumbra(0.25f), 1.0f / 3.0f) << "of the shorter edge";
  EXPECT_EQ(lamp.penumbra(0.0f), 0.0f) << "contact";
  EXPECT_TRUE(std::isfinite(lamp.penumbra(1.0f)));
  const LightRays disc(make_disc({0, 4, 0}, {0, -1, 0}, 0.5f, vec3(1.0f)), r, 1, 1);
  EXPECT_FLOAT_EQ(disc.penumbra(0.5f), 1.0f) << "a diameter";
}

// --- the whole -------------------------------------------------------------------------------------------------------

TEST(RayTracedDenoised, WithoutOccluderLampsAreTheClosedForm) {
  for (const AreaLight& light : {test::lamp, make_disc({0.3f, 2, 0}, {0.2f, -1, 0.1f}, 0.6f, vec3(3.0f, 2.0f, 1.0f))})
    for (const char* backend : backends)
      for (const double share :
           test::visibility(technique, backend, {"rays=1"}, test::lamp_scene({}, plane_grid(19, 18, 0.2f), light)))
        ASSERT_NEAR(share, 1.0, 1e-5) << backend;
}

TEST(RayTracedDenoised, WithoutOccluderEnvironmentsAreTheirIrradiance) {
  Scene scene = test::lamp_scene({}, plane_grid(4, 4, 0.2f));
  Environment environment;
  ASSERT_TRUE(make_environment("sun-sky", environment));
  scene.light = environment;
  const EnvironmentSampler exact(environment);
  for (const bool picture : {false, true}) {
    if (picture)
      for (int i = 0; i < scene.receivers.size(); ++i)
        scene.receivers.normal[i] = glm::normalize(vec3(0.2f * float(i % 4) - 0.3f, 1.0f, 0.2f * float(i / 4) - 0.3f));
    std::vector<vec3> expected;
    expected.reserve(16);
    for (const vec3 n : scene.receivers.normal) expected.push_back(exact.unshadowed(n));
    for (const char* backend : backends)
      EXPECT_LT(test::difference(test::shade(technique, backend, {"rays=2"}, scene), expected), picture ? 1e-3 : 1e-5);
  }
}

TEST(RayTracedDenoised, ConvergesToTheClosedFormOfAHalfPlane) {
  for (const char* backend : backends) {
    double before = 1.0;
    for (const int rays : {1, 4, 16, 64}) {
      const double error = ramp_error(backend, {"rays=" + std::to_string(rays)});
      EXPECT_LT(error, before) << backend << " " << rays;
      before = error;
    }
    EXPECT_LT(before, 0.007) << backend << ": a box of 8 pixels on a ramp of 67";
    EXPECT_LT(ramp_error(backend, {"rays=4"}), 0.25 * ramp_error(backend, {"rays=4", "most=1"})) << backend;
  }
}

TEST(RayTracedDenoised, NothingLeaksAcrossAnEdge) {
  // Two planes side by side in the image. A roof hides the lamp from the lower one, farther than any of its rays
  // reaches the upper one: lit and dark, pixel by pixel. Beside them the same with a crease in place of a step.
  for (const bool step : {true, false}) {
    Receivers grid = plane_grid(32, 16, 0.02f);
    for (int i = 0; i < grid.size(); ++i) {
      if (grid.position[i].x < 0.0f) continue;
      if (step) grid.position[i].y = -1.0f;
      else grid.normal[i] = glm::normalize(vec3(1.0f, 1.0f, 0.0f));
    }
    Scene scene = test::lamp_scene(test::plate({-9.0f, -9.0f}, {9.0f, 9.0f}, -0.5f), grid);
    if (!step) scene.mesh = test::plate({0.0f, -9.0f}, {9.0f, 9.0f}, 1e-4f);
    for (const char* backend : backends) {
      const std::vector<double> share = test::visibility(technique, backend, {"rays=2", "share=4"}, scene);
      for (int i = 0; i < grid.size(); ++i)
        ASSERT_EQ(share[std::size_t(i)] > 0.5, grid.position[i].x < 0.0f) << backend << " " << i % 32;
      for (int i = 0; i < grid.size(); ++i) {
        if (!step && std::abs(grid.position[i].x) < 0.02f) continue;  // the roof's own edge
        ASSERT_NEAR(share[std::size_t(i)], grid.position[i].x < 0.0f ? 1.0 : 0.0, 1e-5) << backend << " " << i % 32;
      }
    }
  }
}

TEST(RayTracedDenoised, WhatShowsNothingStaysBlackAndMixesWithNothing) {
  Receivers grid = plane_grid(20, 12, 0.02f);
  for (int i = 0; i < grid.size(); ++i)
    if (i % 20 == 9) grid.normal[i] = vec3(0.0f);
  const Scene scene = test::lamp_scene(test::plate({-9.0f, -9.0f}, {0.0f, 9.0f}, 1.0f), grid);
  for (const char* backend : backends) {
    const std::vector<vec3> image = test::shade(technique, backend, {"rays=4"}, scene);
    for (int i = 0; i < grid.size(); ++i) {
      ASSERT_TRUE(std::isfinite(image[i].x));
      ASSERT_EQ(image[i] == vec3(0.0f), i % 20 == 9) << backend << " " << i;
    }
  }
}

TEST(RayTracedDenoised, HardCasesAreDefined) {
  const Mesh roof = test::plate({-9.0f, -9.0f}, {9.0f, 9.0f}, 1.0f);
  Receivers unseen = plane_grid(6, 5, 0.1f);
  std::fill(unseen.normal.begin(), unseen.normal.end(), vec3(0.0f));
  const struct {
    const char* name;
    Scene scene;
    bool black;
  } cases[] = {
      {"one pixel", test::lamp_scene({}, plane_grid(1, 1, 0.1f)), false},
      {"one column", test::lamp_scene({}, plane_grid(1, 9, 0.1f)), false},
      {"all dark", test::lamp_scene(roof, plane_grid(9, 9, 0.1f)), true},
      {"nothing seen", test::lamp_scene(roof, unseen), true},
      {"a lamp without size",
       test::lamp_scene({}, plane_grid(9, 9, 0.1f), make_rectangle({0, 4, 0}, {1, 0, 0}, {2, 0, 0}, vec3(1.0f))), true},
      {"a disc without size",
       test::lamp_scene({}, plane_grid(9, 9, 0.1f), make_disc({0, 4, 0}, {0, -1, 0}, 0.0f, vec3(1.0f))), true},
      {"on the lamp", test::lamp_scene({}, plane_grid(9, 9, 0.1f, 4.0f)), true},
      {"behind the lamp", test::lamp_scene({}, plane_grid(9, 9, 0.1f, 5.0f)), true},
      {"a black lamp",
       test::lamp_scene({}, plane_grid(9, 9, 0.1f), make_rectangle({0, 4, 0}, {1, 0, 0}, {0, 0, 1}, vec3(0.0f))), true},
  };
  for (const auto& [name, scene, black] : cases)
    for (const char* backend : backends)
      for (const char* rays : {"rays=1", "rays=5"})
        for (const vec3 radiance : test::shade(technique, backend, {rays}, scene)) {
          for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(radiance[c])) << name;
          ASSERT_EQ(radiance == vec3(0.0f), black) << name << " " << backend;
        }
}

TEST(RayTracedDenoised, VerticesHaveTheRatioOfTheirOwnSums) {
  const std::vector<vec3> points = test::row_of_points(-0.3f, 0.3f, 61);
  const Scene scene = test::lamp_scene(test::plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 1.0f), test::receivers_at(points));
  for (const char* backend : backends) {
    const std::vector<double> found = test::visibility(technique, backend, {"rays=4", "share=4"}, scene);
    int quarters = 0;
    for (const double v : found) quarters += std::abs(4.0 * v - std::round(4.0 * v)) < 0.1;
    EXPECT_EQ(quarters, 61) << backend << ": four rays of about the same weight";
    const std::vector<double> many = test::visibility(technique, backend, {"rays=64"}, scene);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(many[i], test::square_ramp(3.0 * double(points[i].x), 1.0), 0.05);
  }
}

/// Ground seen directly and ground seen in a mirror lie in one plane, and apart.
TEST(RayTracedDenoised, WhatAMirrorShowsIsNotLinkedToWhatIsBesideIt) {
  std::vector<vec3> positions;
  for (int y = 0; y < 3; ++y)
    for (const float x : {0.0f, 0.1f, 0.21f, 2.0f, 2.1f, 2.2f}) positions.emplace_back(x, 0.0f, 0.1f * float(y));
  Receivers r = test::receivers_at(positions);
  r.width = 6, r.height = 3;
  ray_traced_denoised::SurfaceMap map;
  ray_traced_denoised::find_surfaces(r, map);
  for (int y = 0; y < 3; ++y) {
    EXPECT_EQ(map.right[std::size_t(6 * y)], 2);
    EXPECT_EQ(map.right[std::size_t(6 * y + 2)], 0);
    EXPECT_EQ(map.left[std::size_t(6 * y + 5)], 2);
  }
  EXPECT_EQ(map.down[0], 2) << "along columns nothing leaps";
}

}  // namespace
}  // namespace penumbra::ray_traced_denoised
