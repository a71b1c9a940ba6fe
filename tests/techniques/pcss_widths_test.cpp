// How wide the shadow-map family makes its penumbrae: every factor on the way from the lamp to a region of the map.
#include "techniques/bases/shadow_map/samples.h"
#include "techniques/pcss_rotated/pcss_rotated.h"
#include "tests/techniques/lamp_scenes.h"
#include "tests/techniques/random_map.h"

namespace penumbra::pcss_rotated {
namespace {

using namespace test;        // NOLINT: scenes under a lamp
using namespace shadow_map;  // NOLINT: what is tested

const double root_pi = std::sqrt(pi);

TEST(PcssWidths, ADiscIsTheSquareOfItsArea) {
  const AreaLight disc = make_disc({0, 4, 0}, {0, -1, 0}, 0.5f, vec3(10.0f));
  for (const char* name : {"pcss", "hqepcss", "moment-shadows"}) expect_ramp(name, {}, 0.02, disc, 0.5 * root_pi);
}

TEST(PcssWidths, DiscsOfSamplesHaveTheAreaOfTheSquare) {
  const AreaLight disc = make_disc({0, 4, 0}, {0, -1, 0}, 0.5f, vec3(10.0f));
  for (const char* pattern : {"pattern=vogel", "pattern=poisson"}) {
    const std::vector<std::string> many = {pattern, "search_samples=64", "filter_samples=512"};
    expect_ramp("pcss-rotated", many, 0.04, lamp, 1.0 / root_pi, disc_ramp);
    expect_ramp("pcss-rotated", many, 0.04, disc, 0.5, disc_ramp);
  }
}

TEST(PcssWidths, ScalesAreFactorsOnThem) {
  const char* const lattice[] = {"pattern=lattice", "search_samples=64", "filter_samples=256"};
  for (const char* name : {"pcss", "hqepcss", "moment-shadows", "pcss-rotated"})
    for (const auto& [scale, size] :  // a wider filter than 1 would see blockers that the search does not
         {std::pair("filter_scale=0.5", 0.5), {"light_scale=2", 2.0}, {"light_scale=0.5", 0.5}}) {
      const bool rotated = std::string(name) == "pcss-rotated";
      std::vector<std::string> parameters = {scale};
      if (rotated) parameters.insert(parameters.end(), std::begin(lattice), std::end(lattice));
      expect_ramp(name, parameters, rotated ? 0.06 : 0.02, lamp, size);
    }
}

// --- the view --------------------------------------------------------------------------------------------------------

/// Of a plate at depth 3 under the lamp at y = 4, receivers on the ground.
LightView view_of(const AreaLight& light, const LightViewSettings& settings) {
  std::size_t outside = 0;
  return make_light_view(light, plate({-0.5f, -0.2f}, {1.0f, 0.4f}, 1.0f), receivers_at(row_of_points(-1, 1, 5)),
                         settings, outside);
}

TEST(PcssView, WidthsByHand) {
  LightViewSettings settings;
  settings.resolution = 256;
  const LightView near = view_of(lamp, settings);
  EXPECT_FLOAT_EQ(near.near, 3.0f);
  EXPECT_FLOAT_EQ(near.farthest, 4.0f);
  EXPECT_NEAR(near.width(2.0f, 4.0f) / near.density, 0.25, 1e-6) << "1/2 - 1/4 lamp edges";
  EXPECT_NEAR(near.widest() / near.density, 1.0 / 12.0, 1e-6);
  EXPECT_NEAR(near.texel_at(3.0f) * near.density, 3.0, 1e-5) << "q of 1 is an edge of 1 m at a depth of 1 m";
  settings.perspective = false;
  const LightView far = view_of(lamp, settings);
  EXPECT_NEAR(far.width(2.0f, 4.0f) / far.density, 2.0 / 3.0, 1e-6) << "the occluder's middle has depth 3";
  EXPECT_NEAR(far.texel_at(3.0f) * far.density, 1.0, 1e-5);
  EXPECT_EQ(far.region(4.0f, 2.0f), 0.0f) << "not negative";
  EXPECT_EQ(far.region(-1e6f, 2.0f), 256.0f) << "cut to the map";
  settings.light_scale = 3.0;
  EXPECT_NEAR(view_of(lamp, settings).width(2.0f, 4.0f) / view_of(lamp, settings).density, 2.0, 1e-5);
  const LightView wide = view_of(make_rectangle({0, 4, 0}, {0.4f, 0, 0}, {0, 0, 1.6f}, vec3(10.0f)), settings);
  EXPECT_NEAR(wide.texel_at(3.0f) * wide.density, 1.6, 1e-5) << "of its longer edge";
  EXPECT_EQ(view_of(make_disc({0, 4, 0}, {0, -1, 0}, 0.0f, vec3(1.0f)), settings).width(2.0f, 4.0f), 0.0f);
}

/// A box of depths 2 to 3 beside a lamp's axis: what holds for its middle holds for all rays.
TEST(PcssView, ParallelRaysGoFromTheLampToTheMiddleOfTheOccluder) {
  LightViewSettings settings;
  settings.perspective = false;
  std::size_t outside = 0;
  const LightView view = make_light_view(lamp, make_box({0.5f, 1, -1.5f}, {1.0f, 2, -0.5f}),
                                         receivers_at(row_of_points(-1, 1, 5)), settings, outside);
  const vec3 to = vec3(0.75f, 1.5f, -1.0f) - lamp.centre, expected = to / 2.5f;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(view.ray_direction(3, 7)[c], expected[c], 1e-6f) << c;
  EXPECT_NEAR(view.width(2.0f, 4.0f) / view.density, 2.0 / 2.5, 1e-6) << "by the depth of the middle";
}

TEST(PcssView, TheMapReachesPastTheOccluderByItsMargin) {
  const auto places = [](double margin) {  // of the occluder's low and high corner, lamp edges from the map's corner
    LightViewSettings settings;
    settings.resolution = 512;
    settings.margin = margin;
    const LightView view = view_of(lamp, settings);
    return std::array{view.project({-0.5f, 1, 0}, 3.0f).x / view.density,
                      (512.0f - view.project({1.0f, 1, 0}, 3.0f).x) / view.density};
  };
  const float texel = 2.0f * (0.5f + 2.0f * 2.0f / 12.0f) / 512.0f;
  for (const double margin : {0.0, 1.0, 2.0})
    for (const float room : places(margin)) EXPECT_NEAR(room, margin / 12.0, texel) << margin;
}

TEST(PcssView, RaysGoThroughTheMiddlesOfTheirTexels) {
  const AreaLight slanting = make_rectangle({2, 4, 1}, {0.3f, -0.2f, 0.1f}, {0.1f, 0.05f, 0.4f}, vec3(1.0f));
  for (const bool perspective : {true, false}) {
    LightViewSettings settings;
    settings.resolution = 64;
    settings.perspective = perspective;
    const LightView view = view_of(slanting, settings);
    for (const auto& [column, row] : {std::pair(0, 0), {63, 5}, {20, 41}})
      for (const float z : {0.5f, 3.0f}) {
        const vec3 p = view.ray_origin(column, row) + z * view.ray_direction(column, row);
        EXPECT_NEAR(view.depth(p), z, 1e-4f) << "the parameter is the depth";
        EXPECT_NEAR(view.project(p, z).x, float(column) + 0.5f, 2e-3f);
        EXPECT_NEAR(view.project(p, z).y, float(row) + 0.5f, 2e-3f);
      }
    const vec2 low = view.project({-0.5f, 1, -0.2f}, view.depth({-0.5f, 1, -0.2f}));
    EXPECT_TRUE(low.x > 0 && low.y > 0 && low.x < 64 && low.y < 64) << "the occluder lies on the map";
  }
}

TEST(PcssView, ReceiversAreLiftedByTexelsAlongTheirSlope) {
  const LightView view = view_of(lamp, {});
  const float texel = view.texel_at(4.0f);
  EXPECT_NEAR(depth_bias(view, 3.0f, vec3(0), {0, 1, 0}, 4.0f), 3.0f * texel, 1e-6f);
  EXPECT_NEAR(depth_bias(view, 3.0f, vec3(0), glm::normalize(vec3(1, 1, 0)), 4.0f), 6.0f * texel, 1e-6f);
  EXPECT_NEAR(depth_bias(view, 3.0f, vec3(0), {1, 0, 0}, 4.0f), 33.0f * texel, 1e-6f) << "as if at 84 degrees";
  EXPECT_FLOAT_EQ(project(view, {3.0f}, vec3(0), {0, 1, 0}, true).depth, 4.0f - 3.0f * texel);
  EXPECT_FLOAT_EQ(project(view, {3.0f}, vec3(0), {0, 1, 0}, false).depth, 4.0f);
}

TEST(PcssView, WhatAPlaneRisesFromTheMiddleOfARegionToItsEdge) {
  const LightView view = view_of(lamp, {});
  const float texel = view.texel_at(4.0f);
  const vec3 half = glm::normalize(vec3(1, 1, 0)), third = glm::normalize(vec3(1, 3, 0));
  EXPECT_NEAR(region_rise(view, 1.0f, vec3(0), third, 4.0f), texel / 6.0f, 1e-6f) << "a third, over half a texel";
  EXPECT_NEAR(region_rise(view, 0.5f, vec3(0), half, 4.0f), texel / 4.0f, 1e-6f);
  EXPECT_EQ(region_rise(view, 1.0f, vec3(0), {0, 1, 0}, 4.0f), 0.0f) << "it faces the light";
  EXPECT_NEAR(region_rise(view, 1.0f, vec3(0), {1, 0, 0}, 4.0f), 0.75f * texel, 1e-6f) << "as if at 56 degrees";
  EXPECT_FLOAT_EQ(project(view, {3.0f, 1.0f}, vec3(0), half, true).depth, 4.0f - 6.0f * texel) << "of any region";
  EXPECT_NEAR(project(view, {3.0f, 1.0f}, vec3(0), half, true).rise, texel / 2.0f, 1e-6f);
  EXPECT_EQ(project(view, {3.0f, 1.0f}, vec3(0), half, false).rise, 0.0f) << "not on the mesh";
  EXPECT_FLOAT_EQ(blocking_depth(4.0f, 0.001f, 20.0f), 3.98f);
  EXPECT_FLOAT_EQ(blocking_depth(4.0f, 0.01f, 20.0f), 3.92f) << "2 % at most";
  EXPECT_EQ(blocking_depth(4.1f, 0.0f, 1000.0f), 4.1f);
}

// --- patterns --------------------------------------------------------------------------------------------------------

/// Distance of the nearest two points, in units of what a square lattice of as many on an area of 1 has.
double closest(const std::vector<vec2>& points, double area, bool wraps) {
  double least = 1e9;
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      vec2 between = glm::abs(points[a] - points[b]);
      if (wraps) between = glm::min(between, 1.0f - between);
      least = std::min(least, double(glm::length(between)));
    }
  return least * std::sqrt(double(points.size()) / area);
}

TEST(PcssPatterns, PointsKeepApart) {
  for (const int count : {16, 64, 200}) {
    EXPECT_GT(closest(vogel_disc(count), pi, false), 0.8) << count;
    EXPECT_GT(closest(lattice_square(count), 1.0, true), 0.6) << count;
    EXPECT_GT(closest(poisson_disc(count), pi, false), 0.5) << count;
  }
}

TEST(PcssPatterns, VogelsPointsHaveEqualAreas) {
  double mean = 0.0;
  const std::vector<vec2> points = vogel_disc(25);
  for (const vec2& p : points) mean += double(glm::dot(p, p)) / 25.0;
  EXPECT_NEAR(mean, 0.5, 1e-6) << "of r^2 over the disc";
  EXPECT_NEAR(glm::length(points[0]), std::sqrt(0.5 / 25.0), 1e-6);
}

/// One sample beside the point, under an edge: it falls to either side as often, whatever side is covered.
TEST(PcssPatterns, TurnsGoAllTheWayAround) {
  const Receivers many = receivers_at(std::vector<vec3>(900, vec3(0.0f)));
  for (const char* pattern : {"pattern=poisson", "pattern=vogel", "pattern=lattice"})
    for (const auto& [low, high] : {std::pair(vec2(-1.5f, -1.5f), vec2(0.0f, 1.5f)),
                                    {{0.0f, -1.5f}, {1.5f, 1.5f}},
                                    {{-1.5f, -1.5f}, {1.5f, 0.0f}},
                                    {{-1.5f, 0.0f}, {1.5f, 1.5f}}}) {
      double mean = 0.0;
      for (const double v : visibility("pcss-rotated", "scalar", {pattern, "search_samples=64", "filter_samples=1"},
                                       lamp_scene(plate(low, high, 1.0f), many)))
        mean += v / 900.0;
      EXPECT_NEAR(mean, 0.5, 0.06) << pattern << " " << low.x << " " << low.y << " " << high.x;
    }
}

TEST(PcssPatterns, NoiseAndPlacementByHand) {
  EXPECT_EQ(gradient_noise(0, 0), 0.0f);
  const double inner = 0.06711056 * 3 + 0.00583715 * 5, outer = 52.9829189 * inner;  // Jimenez 2014
  EXPECT_NEAR(gradient_noise(3, 5), outer - std::floor(outer), 1e-4);
  EXPECT_EQ(placed(Pattern::vogel, {1, 0}, 0.0f, 1.0f), vec2(0, 1)) << "a quarter turn";
  EXPECT_EQ(placed(Pattern::vogel, {0, 1}, 0.0f, 1.0f), vec2(-1, 0));
  EXPECT_EQ(placed(Pattern::lattice, {0.75f, 0.25f}, 0.5f, 0.5f), vec2(-0.25f, 0.25f)) << "shifted, wrapped, about 0";
}

}  // namespace
}  // namespace penumbra::pcss_rotated
