#include "scenes/fit/solid.h"

#include "scenes/assets.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Mesh turned(Mesh mesh) {
  for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

TEST(Solid, VolumesOfShapes) {
  EXPECT_NEAR(enclosed_volume(make_solid(make_box(vec3(-1.0f), vec3(1, 2, 3)), "box")), 2.0 * 3 * 4, 1e-9);
  EXPECT_NEAR(enclosed_volume(make_solid(make_sphere({9, 9, 9}, 2.0f), "ball")), 4.0 / 3.0 * pi * 8.0, 0.02);
  for (const char* name : {"bunny", "horse"})
    EXPECT_GT(enclosed_volume(make_solid(load_mesh(asset_file(name, "mesh")), name)), 0.1) << name;
}

TEST(Solid, OrientationIsRepaired) {
  const Mesh box = make_box(vec3(0.0f), vec3(1.0f));
  Repairs repairs;
  EXPECT_NEAR(enclosed_volume(make_solid(turned(box), "inside out", &repairs)), 1.0, 1e-9);
  EXPECT_EQ(repairs.flipped_triangles, 12);
  Mesh mixed = box;
  std::swap(mixed.triangles[3].y, mixed.triangles[3].z);
  std::swap(mixed.triangles[8].y, mixed.triangles[8].z);
  EXPECT_NEAR(enclosed_volume(make_solid(mixed, "mixed", &repairs)), 1.0, 1e-9);
  EXPECT_EQ(repairs.flipped_triangles, 2);
  make_solid(box, "good", &repairs);
  EXPECT_FALSE(repairs.any());
}

TEST(Solid, ComponentsBesideAndInside) {
  Mesh beside = make_box(vec3(0.0f), vec3(1.0f));
  append(beside, turned(make_box(vec3(2.0f), vec3(3.0f))));
  EXPECT_NEAR(enclosed_volume(make_solid(beside, "beside")), 2.0, 1e-9);
  for (const bool inside_out : {false, true}) {
    const auto given = [&](const Mesh& mesh) { return inside_out ? turned(mesh) : mesh; };
    Mesh hollow = given(make_box(vec3(0.0f), vec3(4.0f))), full = hollow;
    append(hollow, given(turned(make_box(vec3(1.0f), vec3(3.0f)))));
    append(full, given(make_box(vec3(1.0f), vec3(3.0f))));
    EXPECT_NEAR(enclosed_volume(make_solid(hollow, "hollow")), 64.0 - 8.0, 1e-9) << "it faces the other way: a cavity";
    EXPECT_NEAR(enclosed_volume(make_solid(full, "full")), 64.0, 1e-9) << "it faces the same way: counts once";
    append(hollow, given(make_box(vec3(1.5f), vec3(2.5f))));
    EXPECT_NEAR(enclosed_volume(make_solid(hollow, "island")), 64.0 - 8.0 + 1.0, 1e-9);
    std::swap(hollow.triangles[3].y, hollow.triangles[3].z);
    hollow.triangles.resize(24);
    for (std::size_t t = 12; t < 24; ++t) std::swap(hollow.triangles[t].y, hollow.triangles[t].z);
    EXPECT_NEAR(enclosed_volume(make_solid(hollow, "mixed")), 64.0 - 8.0, 1e-9) << "the file contradicts itself";
  }
}

TEST(Solid, SeamsAndDegenerateTrianglesGo) {
  Mesh box = make_box(vec3(0.0f), vec3(1.0f)), split;
  for (const uvec3& t : box.triangles) {  // no two triangles share a vertex
    const auto first = unsigned(split.positions.size());
    for (int k = 0; k < 3; ++k) split.positions.push_back(box.positions[t[k]]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  split.triangles.push_back({0, 0, 1});
  Repairs repairs;
  EXPECT_EQ(make_solid(split, "seams", &repairs).positions.size(), 8u);
  EXPECT_EQ(repairs.degenerate_triangles, 1);
}

TEST(Solid, DoubleWallsGo) {
  Mesh mesh = make_sphere(vec3(0.0f), 1.0f, 24);
  const uvec3 t = mesh.triangles[100];  // a second wall outside one triangle
  const auto top = unsigned(mesh.positions.size());
  mesh.positions.push_back(1.2f * mesh.positions[t.x]);
  for (int k = 0; k < 3; ++k) mesh.triangles.push_back({t[k], t[(k + 1) % 3], top});
  Repairs repairs;
  EXPECT_GT(enclosed_volume(make_solid(mesh, "wall", &repairs)), 4.0);
  EXPECT_EQ(repairs.double_walls, 1);
}

TEST(Solid, OpenMeshesSayWhatIsOpen) {  // hard case 42
  Mesh open = make_box(vec3(0.0f), vec3(1.0f));
  open.triangles.pop_back();
  const std::string message = test::error_of([&] { make_solid(open, "lid"); });
  for (const char* part : {"lid", "not closed", "3 of", "1 holes"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_NE(test::error_of([] { make_solid(make_bowl(1.0f), "bowl"); }).find("96 of"), std::string::npos);
  Mesh cat = load_mesh(asset_file("cat", "mesh"));
  EXPECT_NE(test::error_of([&] { make_solid(cat, "cat"); }).find("5 holes"), std::string::npos);
  EXPECT_NE(test::error_of([] { make_solid(Mesh{}, "none"); }).find("no triangles"), std::string::npos);
  Mesh dot;
  dot.positions = {vec3(1.0f), vec3(1.0f), vec3(1.0f)};
  dot.triangles = {{0, 1, 2}};
  EXPECT_NE(test::error_of([&] { make_solid(dot, "dot"); }).find("degenerate"), std::string::npos);
}

TEST(Solid, OneSidedMeshesAreRefused) {
  Mesh plane;  // the projective plane as half an icosahedron
  for (int i = 0; i < 6; ++i) plane.positions.emplace_back(std::cos(float(i)), std::sin(2.0f * float(i)), float(i));
  for (const uvec3 t : {uvec3(1, 2, 3), uvec3(1, 3, 4), uvec3(1, 4, 5), uvec3(1, 5, 6), uvec3(1, 6, 2), uvec3(2, 3, 5),
                        uvec3(3, 4, 6), uvec3(4, 5, 2), uvec3(5, 6, 3), uvec3(6, 2, 4)})
    plane.triangles.push_back(t - 1u);
  EXPECT_NE(test::error_of([&] { make_solid(plane, "plane"); }).find("one side only"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
