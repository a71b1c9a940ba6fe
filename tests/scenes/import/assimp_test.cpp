// Formats that Assimp reads.
#include <cstring>

#include "scenes/assets.h"
#include "tests/scenes/import/import_test.h"

namespace penumbra::test {
namespace {

std::string off_box(double shift = 0.0) {
  std::string text = "OFF\n8 6 0\n";
  for (const auto& c : box_corners) text += fmt::format("{:.7f} {} {}\n", c[0] + shift, c[1], c[2]);
  for (const auto& f : box_faces) text += fmt::format("4 {} {} {} {}\n", f[0], f[1], f[2], f[3]);
  return text;
}

struct Facet {
  dvec3 normal, corners[3];
};

std::vector<Facet> facets() {
  std::vector<Facet> out;
  for (const auto& f : box_faces)
    for (int k = 1; k < 3; ++k) {
      const auto at = [&](int i) { return dvec3(box_corners[f[i]][0], box_corners[f[i]][1], box_corners[f[i]][2]); };
      out.push_back({glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0))), {at(0), at(k), at(k + 1)}});
    }
  return out;
}

std::string ascii_stl(const std::vector<Facet>& all, bool normals = true) {
  std::string text = "solid box\n";
  for (const Facet& f : all) {
    const dvec3 n = normals ? f.normal : dvec3(0.0);
    text += fmt::format("facet normal {} {} {}\nouter loop\n", n.x, n.y, n.z);
    for (const dvec3& c : f.corners) text += fmt::format("vertex {} {} {}\n", c.x, c.y, c.z);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string binary_stl(bool normals) {
  std::string bytes(80, '\0');
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint32_t(12));
  for (const Facet& f : facets()) {
    for (int c = 0; c < 3; ++c) put(normals ? float(f.normal[c]) : 0.0f);
    for (const dvec3& corner : f.corners)
      for (int c = 0; c < 3; ++c) put(float(corner[c]));
    put(std::uint16_t(0));
  }
  return bytes;
}

TEST_F(Import, Off) {
  const ImportedMesh mesh = read("a.off", off_box());
  expect_box(mesh, "OFF");
  EXPECT_TRUE(mesh.normals.empty()) << "smooth";
  EXPECT_EQ(read("B.OFF", off_box()).positions.size(), 8u);
  EXPECT_THAT(log("far.off", off_box(500000.1)), HasSubstr("up to 0.016 of the file's units"));
  EXPECT_EQ(log("near.off", off_box()), "");
}

TEST_F(Import, StlIsFlat) {
  for (const bool normals : {true, false})
    for (const std::string& text : {ascii_stl(facets(), normals), binary_stl(normals)}) {
      const ImportedMesh mesh = read("a.stl", text);
      expect_box(mesh, "STL", 24);
      expect_flat(mesh, "STL");
    }
}

/// The facets' normals repeat the winding: where they contradict it, the volume tells which is right.
TEST_F(Import, StlWithWrongNormals) {
  std::vector<Facet> all = facets();
  for (Facet& f : all) f.normal = -f.normal;
  expect_flat(read("normals.stl", ascii_stl(all)), "outward winding, inward normals");
  for (Facet& f : all) f.normal = -f.normal, std::swap(f.corners[1], f.corners[2]);
  const ImportedMesh mesh = read("winding.stl", ascii_stl(all));
  expect_box(mesh, "inward winding, outward normals", 24);
  expect_flat(mesh, "inward winding, outward normals");
  for (Facet& f : all) f.normal = -f.normal;
  EXPECT_NEAR(volume(read("room.stl", ascii_stl(all))), -0.216, 1e-7) << "both inward";
}

TEST_F(Import, ColladaNodesThatMirror) {
  std::string corners, indices;
  for (const auto& c : box_corners) corners += fmt::format("{} {} {} ", c[0], c[1], c[2]);
  for (const auto& f : box_faces) indices += fmt::format("{} {} {} {} ", f[0], f[1], f[2], f[3]);
  const std::string text = fmt::format(
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="24">{}</float_array><technique_common><accessor source="#pa" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/>
<vcount>4 4 4 4 4 4</vcount><p>{}</p></polylist></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node id="n"><scale>-1 1 1</scale><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
      corners, indices);
  expect_box(read("a.dae", text), "mirrored");
  expect_box(read("a.dae", replaced(text, "-1 1 1</scale>", "1 1 1</scale>")), "plain");
}

TEST_F(Import, ThreeDsKeepsItsSmoothingGroups) {
  const ImportedMesh horse = import_mesh(asset_file("horse", "mesh"));
  ASSERT_EQ(horse.normals.size(), horse.positions.size());
  EXPECT_GT(horse.triangles.size(), horse.positions.size());
  for (const vec3& n : horse.normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
}

TEST_F(Import, SkeletonsAreNoBodies) {
  EXPECT_THAT(error("walk.bvh",
                    "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\n"
                    "OFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.03\n0 0 0\n"),
              HasSubstr("walk.bvh: "));
}

TEST_F(Import, FilesOfNoKindAreRefused) {
  for (const char* name : {"a.xyz", "noextension", "a.obj.gz", "a.3ds", "a.off", "a.stl", "a.fbx", "a.dae"}) {
    const std::string message = error(name, "hello\n");
    EXPECT_THAT(message, HasSubstr(folder.path() + "/" + name + ": ")) << name;
    EXPECT_EQ(message.find('\n'), message.npos) << name;
  }
  EXPECT_THAT(error_of([&] { import_mesh(folder.path()); }), HasSubstr("not a file"));
  EXPECT_THAT(error_of([] { import_mesh("/nowhere/x.obj"); }), HasSubstr("no such mesh"));
}

TEST_F(Import, ObjWithoutAnExtensionIsKnownByItsLines) {
  const std::string text = "# made by hand\nv 0 0 0\nv 1 0 0\nv .0 1 0\nf 1 2 3\n";
  for (const char* name : {"mesh", "mesh.txt", "MESH.OBJ"}) EXPECT_EQ(read(name, text).triangles.size(), 1u) << name;
}

}  // namespace
}  // namespace penumbra::test
