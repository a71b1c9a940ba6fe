// Fits of solids that touch, overlap or are doubled, against Monte Carlo that knows nothing of triangles (unions of
// boxes) or sums solid angles (generalised winding number, Jacobson et al. 2013).
#include <random>

#include "scenes/fit/fit.h"
#include "scenes/fit/solid.h"
#include "scenes/fit/union_surface.h"
#include "tests/support.h"

namespace penumbra {
namespace {

struct Box {
  vec3 low, high;
};

Mesh mesh_of(const std::vector<Box>& boxes) {
  Mesh mesh;
  for (const Box& b : boxes) append(mesh, make_box(b.low, b.high));
  return mesh;
}

Mesh turned(Mesh mesh) {
  for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

template <class Map>
Mesh mapped(Mesh mesh, Map map) {
  for (vec3& p : mesh.positions) p = map(p);
  return mesh;
}

bool in_boxes(const std::vector<Box>& boxes, const dvec3& p) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) {
    return glm::all(glm::lessThan(dvec3(b.low), p)) && glm::all(glm::lessThan(p, dvec3(b.high)));
  });
}

/// Sum of signed solid angles over 4 pi (Van Oosterom & Strackee 1983).
double winding_number(const Mesh& mesh, const dvec3& p) {
  double sum = 0.0;
  for (const uvec3& t : mesh.triangles) {
    const dvec3 a = dvec3(mesh.positions[t.x]) - p, b = dvec3(mesh.positions[t.y]) - p,
                c = dvec3(mesh.positions[t.z]) - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += std::atan2(glm::dot(a, glm::cross(b, c)),
                      la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (2.0 * pi);
}

/// The figures of a fit by counting random points in the box of solid and spheres.
template <class Inside>
FitQuality counted(const Bounds& solid, const SphereSet& set, Inside inside, int points = 400000) {
  const Bounds balls = bounds(set);
  const dvec3 low = glm::min(solid.low, balls.low), extent = dvec3(glm::max(solid.high, balls.high)) - low;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  FitQuality sum;
  for (int i = 0; i < points; ++i) {
    const double u = uniform(random), v = uniform(random), w = uniform(random);
    const dvec3 p = low + extent * dvec3(u, v, w);
    int holding = 0;
    for (const Sphere& s : set.spheres) holding += glm::distance(p, dvec3(s.centre)) < s.radius;
    const bool in = inside(p);
    sum.volume += in;
    sum.uncovered += in && holding == 0;
    if (!in) sum.outside += holding, sum.excess += holding > 0;
  }
  const double each = extent.x * extent.y * extent.z / points;
  return {each * sum.volume, each * sum.outside, each * sum.excess, each * sum.uncovered};
}

template <class Inside>
void expect_as_counted(const Mesh& mesh, const SphereSet& set, Inside inside, const std::string& what) {
  const FitQuality q = assess_fit(mesh, set, what), c = counted(bounds(mesh), set, inside);
  const double near = 0.012 * c.volume;  // four standard errors of the counting, where boxes are not much larger
  EXPECT_NEAR(q.volume, c.volume, near) << what;
  EXPECT_NEAR(q.outside, c.outside, near + 0.01 * c.outside) << what;
  EXPECT_NEAR(q.excess, c.excess, near) << what;
  EXPECT_NEAR(q.uncovered, c.uncovered, near) << what;
  EXPECT_LE(q.excess, q.outside) << what;
}

void expect_fit_as_counted(const std::vector<Box>& boxes, double volume, const std::string& what,
                           const FitRequest& request = {3, Objective::cover}) {
  const Mesh mesh = mesh_of(boxes);
  EXPECT_NEAR(enclosed_volume(make_solid(mesh, what)), volume, 2e-6 * volume) << what;
  SphereSet set = fit_spheres(mesh, request, what);
  if (request.objective == Objective::cover) EXPECT_LT(assess_fit(mesh, set).uncovered, 1e-6 * volume) << what;
  for (Sphere& s : set.spheres) s.radius *= 0.9f;  // so that something is uncovered
  expect_as_counted(
      mesh, set, [&](const dvec3& p) { return in_boxes(boxes, p); }, what);
}

std::vector<Box> voxels(int nx, int ny, int nz) {
  std::vector<Box> boxes;
  for (int i = 0; i < nx * ny * nz; ++i) {
    const vec3 low(float(i % nx), float(i / nx % ny), float(i / nx / ny));
    boxes.push_back({low, low + 1.0f});
  }
  return boxes;
}

TEST(Touching, OverlappingSolidsCountOnce) {
  expect_fit_as_counted({{vec3(0.0f), vec3(1.0f)}, {vec3(0.5f), vec3(1.5f)}}, 1.875, "overlap", {8});
  expect_fit_as_counted({{{-3, -1, -1}, {3, 1, 1}}, {{-1, -3, -1}, {1, 3, 1}}, {{-1, -1, -3}, {1, 1, 3}}}, 56.0,
                        "cross");
  expect_fit_as_counted({{vec3(0.0f), vec3(4.0f)}, {vec3(1.0f), vec3(2.0f)}}, 64.0, "a solid in a solid");
}

TEST(Touching, DoubledSolidsCountOnce) {
  const Box box{{-0.3f, 0, -0.3f}, {0.3f, 0.6f, 0.3f}};
  expect_fit_as_counted({box, box}, 0.216, "twice", {8});
  expect_fit_as_counted({box, box, box}, 0.216, "three times");
  Mesh both_sides = mesh_of({box});
  append(both_sides, turned(mesh_of({box})));
  EXPECT_NEAR(enclosed_volume(make_solid(both_sides, "both sides")), 0.216, 1e-7);
  Mesh other_diagonals = mesh_of({box});  // coincident faces, but no common triangles
  append(other_diagonals, mapped(turned(mesh_of({box})), [](vec3 p) { return vec3(-p.x, p.y, p.z); }));
  const Mesh solid = make_solid(other_diagonals, "other diagonals");
  EXPECT_NEAR(enclosed_volume(solid), 0.216, 1e-7);
  expect_as_counted(
      other_diagonals, SphereSet{{{{0, 0.3f, 0}, 0.4f}, {{0.1f, 0.3f, 0}, 0.3f}}},
      [&](const dvec3& p) { return in_boxes({box}, p); }, "other diagonals");
}

TEST(Touching, CubesThatShareFacesEdgesAndCorners) {
  expect_fit_as_counted(voxels(2, 2, 2), 8.0, "voxels", {8});
  expect_fit_as_counted(voxels(3, 1, 1), 3.0, "a row");
  expect_fit_as_counted({{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 0}, {2, 2, 1}}}, 2.0, "an edge");
  expect_fit_as_counted({{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}}, 2.0, "a corner");
  expect_fit_as_counted({{{0, 0, 0}, {2, 2, 2}}, {{2, 0.5f, 0.5f}, {3, 1.5f, 1.5f}}}, 9.0, "part of a face");
  expect_fit_as_counted({{{0, 0, 0}, {2, 2, 2}}, {{2, 1, 0}, {3, 3, 1}}}, 10.0, "part of a face and of an edge");
  std::vector<Box> stairs = voxels(3, 3, 3);
  std::erase_if(stairs, [](const Box& b) { return b.low.x + b.low.y > 2.0f || b.low == vec3(1.0f); });
  expect_fit_as_counted(stairs, double(stairs.size()), "stairs about a hollow");
}

/// Boxes with corners on a lattice: the union's volume is a number of cells, and next to everything coincides
/// somewhere.
TEST(Touching, HeapsOfBoxesOnALattice) {
  std::mt19937 random(11);
  for (int heap = 0; heap < 60; ++heap) {
    std::vector<Box> boxes;
    for (int i = 0; i < 2 + heap / 4; ++i) {
      Box& b = boxes.emplace_back();
      for (int c = 0; c < 3; ++c) {
        b.low[c] = float(random() % 5);
        b.high[c] = b.low[c] + 1.0f + float(random() % 3);
      }
    }
    int cells = 0;
    for (int i = 0; i < 512; ++i) cells += in_boxes(boxes, dvec3(i % 8, i / 8 % 8, i / 64) + 0.5);
    const auto askew = [](vec3 p) {
      return vec3(0.36f * p.x + 0.48f * p.y - 0.8f * p.z, -0.8f * p.x + 0.6f * p.y,
                  0.48f * p.x + 0.64f * p.y + 0.6f * p.z);
    };
    EXPECT_NEAR(enclosed_volume(make_solid(mesh_of(boxes), "heap")), cells, 1e-5 * cells) << heap;
    EXPECT_NEAR(enclosed_volume(make_solid(mapped(mesh_of(boxes), askew), "heap")), cells, 1e-4 * cells) << heap;
  }
}

TEST(Touching, ContradictoryOrientationIsRepaired) {
  std::mt19937 random(3);
  for (const auto& [boxes, volume] : {std::pair{voxels(2, 2, 2), 8.0},
                                      {voxels(2, 1, 1), 2.0},
                                      {{{vec3(0.0f), vec3(1.0f)}, {{1, 1, 0}, {2, 2, 1}}}, 2.0}}) {
    Mesh mesh = mesh_of(boxes);
    for (uvec3& t : mesh.triangles)
      if (random() % 2) std::swap(t.y, t.z);
    EXPECT_NEAR(enclosed_volume(make_solid(mesh, "contradictory")), volume, 1e-6);
    Mesh one_turned = mesh_of(boxes);
    for (std::size_t t = 0; t < 12; ++t) std::swap(one_turned.triangles[t].y, one_turned.triangles[t].z);
    EXPECT_NEAR(enclosed_volume(make_solid(one_turned, "one inside out")), volume, 1e-6);
  }
  Mesh tetrahedra;  // two share a face that each brings along, one of them inside out
  tetrahedra.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  tetrahedra.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {1, 2, 3}, {4, 1, 2}, {4, 2, 3}, {4, 3, 1}};
  EXPECT_NEAR(enclosed_volume(make_solid(tetrahedra, "tetrahedra")), 1.0 / 6.0 + 1.0 / 3.0, 1e-6);
  std::erase(tetrahedra.triangles, uvec3(1, 2, 3));  // neither brings it: one solid
  EXPECT_NEAR(enclosed_volume(make_solid(tetrahedra, "one solid")), 0.5, 1e-6);
}

TEST(Touching, AgreesWithTheWindingNumber) {
  const auto askew = [](vec3 p) {  // no coordinate is round, and nothing lies along an axis
    return vec3(0.36f * p.x + 0.48f * p.y - 0.8f * p.z + 0.1f, -0.8f * p.x + 0.6f * p.y,
                0.48f * p.x + 0.64f * p.y + 0.6f * p.z - 0.3f);
  };
  Mesh balls = make_sphere({0.1f, 0, 0}, 0.8f, 24);
  append(balls, make_sphere({0.9f, 0.3f, 0.2f}, 0.7f, 16));
  append(balls, make_torus_knot(2, 3, 48, 8));
  const std::pair<std::string, Mesh> cases[] = {
      {"askew cubes", mapped(mesh_of(voxels(2, 2, 1)), askew)},
      {"askew overlap", mapped(mesh_of({{vec3(0.0f), vec3(1.0f)}, {vec3(0.4f), vec3(1.7f)}}), askew)},
      {"askew, part of a face", mapped(mesh_of({{vec3(0.0f), vec3(2.0f)}, {{2, 0.5f, 0.3f}, {3, 1.5f, 1.7f}}}), askew)},
      {"balls and knot", balls}};
  for (const auto& [what, mesh] : cases) {
    const Bounds box = bounds(mesh);
    const auto inside = [&mesh = mesh](const dvec3& p) { return winding_number(mesh, p) > 0.5; };
    const SphereSet set{
        {{box.centre(), 0.5f * box.extent().x}, {box.low + 0.3f * box.extent(), 0.4f * box.extent().y}}};
    const FitQuality q = assess_fit(mesh, set, what), c = counted(box, set, inside, 40000);
    const dvec3 extent = box.extent();
    const double near = 0.012 * extent.x * extent.y * extent.z;  // standard error below 0.0035 of it
    EXPECT_NEAR(q.volume, c.volume, near) << what;
    EXPECT_NEAR(q.outside, c.outside, 2.0 * near) << what;
    EXPECT_NEAR(q.excess, c.excess, near) << what;
    EXPECT_NEAR(q.uncovered, c.uncovered, near) << what;
  }
}

TEST(Touching, TheUnionsSurfaceWindsOnce) {
  Mesh mesh = mesh_of(voxels(2, 2, 1));
  append(mesh, mesh_of({{vec3(0.3f), vec3(1.7f)}, {vec3(0.3f), vec3(1.7f)}}));
  append(mesh, make_sphere({1, 1, 1}, 0.9f, 12));
  const Mesh solid = make_solid(mesh, "heap");
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.5, 2.5);
  int in = 0;
  for (int i = 0; i < 3000; ++i) {
    const double u = uniform(random), v = uniform(random), w = uniform(random);
    const double turns = winding_number(solid, {u, v, w});
    const bool expected = winding_number(mesh, {u, v, w}) > 0.5;
    ASSERT_NEAR(turns, expected ? 1.0 : 0.0, 1e-3) << u << " " << v << " " << w;
    in += expected;
  }
  EXPECT_GT(in, 400);
}

TEST(Touching, WhatTouchesNothingStaysAsItIs) {
  const Mesh knot = make_torus_knot(2, 3, 96, 12);
  int dropped = -1;
  EXPECT_EQ(union_surface(knot, "knot", &dropped).positions, knot.positions);
  EXPECT_EQ(union_surface(knot, "knot").triangles, knot.triangles);
  EXPECT_EQ(dropped, 0);
  const Mesh gap = make_solid(mesh_of({{vec3(0.0f), vec3(1.0f)}, {{1.001f, 0, 0}, {2.001f, 1, 1}}}), "gap");
  EXPECT_EQ(gap.triangles.size(), 24u);
}

TEST(Touching, WallsWithoutThicknessCastShadows) {
  Mesh mesh = make_box(vec3(0.0f), vec3(1.0f));
  Mesh leaf;  // beside the box, written with both sides
  leaf.positions = {{2, 0, 0}, {3, 0, 0.1f}, {3, 1, 0.2f}, {2, 1, 0.1f}};
  leaf.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}};
  append(mesh, leaf);
  const Mesh solid = make_solid(mesh, "leaf");
  EXPECT_EQ(solid.triangles.size(), 16u);
  EXPECT_NEAR(enclosed_volume(solid), 1.0, 1e-6);
  EXPECT_EQ(without_walls(solid).triangles.size(), 12u);
  const SphereSet set = fit_spheres(mesh, {6, Objective::cover});
  for (const vec3& p : leaf.positions)
    EXPECT_TRUE(std::any_of(set.spheres.begin(), set.spheres.end(),
                            [&](const Sphere& s) { return glm::distance(s.centre, p) <= s.radius; }));
  EXPECT_LT(assess_fit(mesh, set).uncovered, 1e-6);
}

TEST(Touching, UnitsDoNotMatter) {
  const Mesh overlap = mesh_of({{vec3(0.0f), vec3(1.0f)}, {vec3(0.5f), vec3(1.5f)}}),
             box = mesh_of({{{-0.3f, 0, -0.3f}, {0.3f, 0.6f, 0.3f}}});
  const auto scaled = [](SphereSet set, float scale) {
    for (Sphere& s : set.spheres) s = {scale * s.centre, scale * s.radius};
    return set;
  };
  const auto expect_alike = [](const FitQuality& a, const FitQuality& b, double near, float scale) {
    EXPECT_NEAR(a.outside / a.volume, b.outside / b.volume, near) << scale;
    EXPECT_NEAR(a.excess / a.volume, b.excess / b.volume, near) << scale;
    EXPECT_NEAR(a.uncovered / a.volume, b.uncovered / b.volume, near) << scale;
  };
  for (const Mesh& mesh : {overlap, box}) {
    const SphereSet metres = fit_spheres(mesh, {4, Objective::cover});
    const FitQuality quality = assess_fit(mesh, metres);
    for (const float scale : {1e-9f, 1e-6f, 1e9f}) {
      const Mesh other = mapped(mesh, [&](vec3 p) { return scale * p; });
      expect_alike(assess_fit(other, scaled(metres, scale)), quality, 1e-5, scale);
      const SphereSet set = fit_spheres(other, {4, Objective::cover});
      ASSERT_EQ(set.size(), metres.size());
      for (std::size_t i = 0; i < set.size(); ++i) {
        EXPECT_LT(glm::distance(set.spheres[i].centre / scale, metres.spheres[i].centre), 3e-6f) << scale;
        EXPECT_NEAR(set.spheres[i].radius / scale, metres.spheres[i].radius, 3e-6) << scale;
      }
    }
    for (const float scale : {0x1p-30f, 0x1p30f}) {  // nothing rounds
      const SphereSet set = fit_spheres(mapped(mesh, [&](vec3 p) { return scale * p; }), {4, Objective::cover});
      ASSERT_EQ(set.size(), metres.size());
      for (std::size_t i = 0; i < set.size(); ++i) {
        EXPECT_EQ(set.spheres[i].centre, scale * metres.spheres[i].centre) << scale;
        EXPECT_EQ(set.spheres[i].radius, scale * metres.spheres[i].radius) << scale;
      }
    }
  }
}

TEST(Touching, PointsOfNoTriangleDoNotCount) {
  Mesh mesh = mesh_of({{vec3(0.0f), vec3(1.0f)}, {vec3(0.5f), vec3(1.5f)}});
  const SphereSet plain = fit_spheres(mesh, {4});
  mesh.positions.insert(mesh.positions.begin(), vec3(1000.0f, -7.0f, 3.0f));
  mesh.positions.push_back(vec3(-1e6f));
  for (uvec3& t : mesh.triangles) t += 1u;
  const SphereSet set = fit_spheres(mesh, {4});
  ASSERT_EQ(set.size(), plain.size());
  for (std::size_t i = 0; i < set.size(); ++i) EXPECT_EQ(set.spheres[i].centre, plain.spheres[i].centre);
  EXPECT_EQ(assess_fit(mesh, set).outside, assess_fit(mesh, plain).outside);
}

TEST(Touching, BrokenMeshesEndInWordsOrInAFit) {
  const auto refused = [](const Mesh& mesh, const std::string& words) {
    const std::string message = test::error_of([&] { fit_spheres(mesh, {4}, "broken"); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  Mesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  refused(triangle, "not closed");
  Mesh many = triangle;  // an even number of copies has no open edge: a wall
  many.triangles.assign(100000, uvec3(0, 1, 2));
  EXPECT_FALSE(fit_spheres(many, {4}).empty());
  many.triangles.push_back({0, 1, 2});
  refused(many, "not closed");
  Mesh box = make_box(vec3(0.0f), vec3(1.0f));
  box.triangles.insert(box.triangles.end(), 100000, box.triangles[0]);
  EXPECT_NEAR(enclosed_volume(make_solid(box, "copies")), 1.0, 1e-6);
  Mesh open = make_box(vec3(0.0f), vec3(1.0f));
  open.triangles.resize(10);
  refused(open, "not closed");
  Mesh strip;  // Moebius
  for (int i = 0; i < 20; ++i) {
    const float a = float(i) * float(pi) / 10.0f;
    for (const float w : {-0.2f, 0.2f})
      strip.positions.emplace_back((1.0f + w * std::cos(a / 2)) * std::cos(a),
                                   (1.0f + w * std::cos(a / 2)) * std::sin(a), w * std::sin(a / 2));
  }
  for (unsigned i = 0; i < 20; ++i) {
    const unsigned a = 2 * i, b = 2 * i + 1, c = i < 19 ? a + 2 : 1, d = i < 19 ? b + 2 : 0;
    strip.triangles.push_back({a, b, c}), strip.triangles.push_back({b, d, c});
  }
  refused(strip, "not closed");
  Mesh flat = make_box(vec3(0.0f), {1, 0, 1});  // a quad with two sides, and sides without area
  EXPECT_FALSE(fit_spheres(flat, {4}).empty());
  Mesh slivers = make_box(vec3(0.0f), vec3(1.0f));  // closed, with triangles of no area on its edges
  const uvec3 t = slivers.triangles[0];
  slivers.positions.push_back(0.5f * (slivers.positions[t.x] + slivers.positions[t.y]));
  const auto middle = unsigned(slivers.positions.size() - 1);
  slivers.triangles[0] = {t.x, middle, t.z};
  slivers.triangles.push_back({middle, t.y, t.z}), slivers.triangles.push_back({t.x, t.y, middle});
  EXPECT_NEAR(enclosed_volume(make_solid(slivers, "slivers")), 1.0, 1e-6);
  EXPECT_FALSE(fit_spheres(slivers, {4}).empty());
  Mesh gone = make_box(vec3(0.0f), vec3(1.0f));
  gone.positions[3].y = std::numeric_limits<float>::quiet_NaN();
  refused(gone, "not finite");
  refused(mapped(make_box(vec3(-1.0f), vec3(1.0f)), [](vec3 p) { return 2e38f * p; }), "single precision");
}

}  // namespace
}  // namespace penumbra
