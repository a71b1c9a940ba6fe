#include "scenes/assets.h"
#include "scenes/import/polygon.h"
#include "tests/scenes/import/import_test.h"

namespace penumbra::test {
namespace {

const std::string positions =
    "v -0.3 0 -0.3\nv 0.3 0 -0.3\nv -0.3 0.6 -0.3\nv 0.3 0.6 -0.3\nv -0.3 0 0.3\nv 0.3 0 0.3\nv -0.3 0.6 0.3\n"
    "v 0.3 0.6 0.3\n";
const std::string faces = "f 2 4 8 6\nf 1 5 7 3\nf 3 7 8 4\nf 1 2 6 5\nf 5 6 8 7\nf 1 3 4 2\n";
const std::string normals = "vn 1 0 0\nvn -1 0 0\nvn 0 1 0\nvn 0 -1 0\nvn 0 0 1\nvn 0 0 -1\n";
const std::string faces_with_normals =
    "f 2//1 4//1 8//1 6//1\nf 1//2 5//2 7//2 3//2\nf 3//3 7//3 8//3 4//3\nf 1//4 2//4 6//4 5//4\n"
    "f 5//5 6//5 8//5 7//5\nf 1//6 3//6 4//6 2//6\n";
const std::string box = positions + faces;

TEST_F(Import, ObjSyntax) {
  const std::pair<std::string, std::string> files[] = {
      {"plain", box},
      {"byte-order mark", "\xEF\xBB\xBF" + box},
      {"comment that ends in a backslash", "# C:\\models\\\n" + box},
      {"comment behind numbers that ends in a backslash", replaced(box, "8 6\n", "8 6 # C:\\temp\\\n")},
      {"no zero before the point", replaced(box, "0.", ".")},
      {"no digit behind the point", replaced(box, " 0 ", " 0. ")},
      {"exponents", replaced(box, "0.3", "3e-1")},
      {"plus signs and capitals", replaced(box, " 0.6", " +6.0E-01")},
      {"tabs", replaced(box, " ", "\t")},
      {"CRLF", replaced(box, "\n", "\r\n")},
      {"CR", replaced(box, "\n", "\r")},
      {"continued lines", replaced(box, "f 2 4 8 6", "f 2 4\\\n 8 \\\r\n6")},
      {"leading blanks", replaced(box, "\n", "\n  ")},
      {"no newline at the end", box.substr(0, box.size() - 1)},
      {"colours", replaced(box, "v -0.3 0 -0.3\n", "v -0.3 0 -0.3 1 0.5 0\n")},
      {"weights", replaced(box, "v -0.3 0 -0.3\n", "v -0.3 0 -0.3 2.0\n")},
      {"groups, a missing library, lines and points",
       "mtllib nothere.mtl\no a\n" + positions + "v 3000 0 0\ng b\nusemtl m\nl 1 9\np 9\n" + faces},
      {"relative indices", positions + replaced(faces, "f 2 4 8 6\nf 1 5 7 3", "f -7 -5 -1 -3\nf -8 -4 -2 -6")},
      {"texture coordinates",
       positions + "vt 0 0\n" +
           replaced(faces, "f 2 4 8 6\nf 1 5 7 3\nf 3 7 8 4\nf 1 2 6 5",
                    "f 2/1 4/1 8/1 6/1\nf 1/ 5/ 7/ 3/\nf 3/1/ 7/1/ 8/1/ 4/1/\nf 1// 2// 6// 5//")},
      {"faces before vertices", faces + positions},
      {"degenerate faces", box + "f 1 1 2\nf 1 2\nf 3\nf 1 2 1 2\n"},
      {"unused vertices that are no numbers", box + "v nan inf 0\n"},
      {"one smoothing group", positions + "s 1\n" + faces},
  };
  for (const auto& [what, text] : files) {
    const ImportedMesh mesh = read("a.obj", text);
    expect_box(mesh, what);
    EXPECT_TRUE(mesh.normals.empty()) << what;
  }
}

TEST_F(Import, ObjNumbersAreRoundedCorrectly) {
  const ImportedMesh mesh = read("utm.obj",
                                 "v 500000.123456 4649776.654321 120.000001\nv 500000.123457 4649776.654321 120\n"
                                 "v 500000.123456 4649776.754321 120\nf 1 2 3\n");
  EXPECT_EQ(mesh.positions[0], dvec3(500000.123456, 4649776.654321, 120.000001));
  EXPECT_EQ(mesh.positions[1].x, 500000.123457);
  const ImportedMesh extreme = read("e.obj", "v 1e-400 -1e-310 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(extreme.positions[0], dvec3(0.0, -1e-310, 0.0));
}

TEST_F(Import, VerticesAreJoinedWhereTheyAreEqualAndNowhereElse) {
  for (const double unit : {5e-6, 1e-12, 1e-30}) {
    std::string text;
    for (const auto& c : box_corners) text += fmt::format("v {} {} {}\n", unit * c[0], unit * c[1], unit * c[2]);
    EXPECT_EQ(read("tiny.obj", text + faces).positions.size(), 8u) << unit;
  }
  const ImportedMesh zeros =
      read("z.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 -0 0\nv 1 0 -0\nv 0 -1 0\nf 1 2 3\nf 6 5 4\n");
  EXPECT_EQ(zeros.positions.size(), 4u) << "0 and -0 are one place";
}

TEST_F(Import, ObjNormalsOfTheFileAreKept) {
  const ImportedMesh mesh = read("a.obj", positions + normals + faces_with_normals);
  expect_box(mesh, "normals", 24);
  expect_flat(mesh, "normals");
  std::string long_ones = replaced(positions + normals + faces_with_normals, "vn 1 0 0", "vn 40 0 0");
  expect_flat(read("long.obj", long_ones), "length");
  const ImportedMesh none = read("zero.obj", replaced(long_ones, "vn 40 0 0", "vn 0 0 0"));
  EXPECT_EQ(std::count(none.normals.begin(), none.normals.end(), vec3(0.0f)), 4) << "zero: not given";
  EXPECT_EQ(std::count(none.normals.begin(), none.normals.end(), vec3(0, 1, 0)), 4);
}

TEST_F(Import, ObjSmoothingGroups) {
  for (const char* off : {"s off\n", "s 0\n"}) {
    const ImportedMesh mesh = read("a.obj", positions + off + faces);
    expect_box(mesh, off, 24);
    expect_flat(mesh, off);
  }
  std::string one_by_one = positions;  // every face a group of its own
  int group = 0;
  for (const auto& f : box_faces)
    one_by_one += fmt::format("s {}\nf {} {} {} {}\n", ++group, f[0] + 1, f[1] + 1, f[2] + 1, f[3] + 1);
  expect_flat(read("b.obj", one_by_one), "six groups");
  // Two roofs: a and b meet smoothly, c is apart.
  const ImportedMesh roof = read("c.obj",
                                 "v 0 0 0\nv 1 1 0\nv 2 0 0\nv 3 1 0\nv 0 0 1\nv 1 1 1\nv 2 0 1\nv 3 1 1\n"
                                 "s 1\nf 1 5 6 2\nf 2 6 7 3\ns 2\nf 3 7 8 4\n");
  EXPECT_EQ(roof.positions.size(), 10u);
  for (std::size_t i = 0; i < roof.positions.size(); ++i)
    if (roof.positions[i].x == 1.0) EXPECT_LT(glm::distance(roof.normals[i], vec3(0, 1, 0)), 1e-6f);
}

TEST_F(Import, OrientationFollowsNormals) {
  const std::string ccw = positions + normals + faces_with_normals;
  std::string cw = positions + normals;
  for (int f = 0; f < 6; ++f) {
    cw += "f";
    for (int k = 3; k >= 0; --k) cw += fmt::format(" {}//{}", box_faces[f][k] + 1, f + 1);
    cw += "\n";
  }
  EXPECT_NEAR(volume(read("cw.obj", cw)), 0.216, 1e-12);
  EXPECT_THAT(log("cw.obj", cw), HasSubstr("12 of 12 triangles are wound against"));
  EXPECT_EQ(log("ccw.obj", ccw), "");
  const std::string mixed = replaced(ccw, "f 2//1 4//1 8//1 6//1", "f 6//1 8//1 4//1 2//1");
  EXPECT_NEAR(volume(read("mixed.obj", mixed)), 0.216, 1e-12) << "one face alone";
  const std::string inward =
      positions + "vn -1 0 0\nvn 1 0 0\nvn 0 -1 0\nvn 0 1 0\nvn 0 0 -1\nvn 0 0 1\n" + faces_with_normals;
  EXPECT_NEAR(volume(read("inward.obj", inward)), -0.216, 1e-12) << "a room: seen from inside";
}

TEST_F(Import, AStrayNormalDoesNotOpenASurface) {
  std::string text = positions;  // smooth normals, one of which points inward
  for (const auto& c : box_corners) text += fmt::format("vn {} {} {}\n", c[0], c[1] - 0.3, c[2]);
  text = replaced(text, "vn 0.3 0.3 0.3", "vn -9 -9 -9");
  for (const auto& f : box_faces) {
    text += "f";
    for (const unsigned i : f) text += fmt::format(" {0}//{0}", i + 1);
    text += "\n";
  }
  expect_box(read("stray.obj", text), "stray");
}

TEST_F(Import, ObjErrorsNameTheLine) {
  const std::pair<std::string, const char*> files[] = {
      {positions + "f 1 2 9\n", ":9: vertex 9 is out of range"},
      {positions + "\n\\\n\nf 1 2 -9\n", "a.obj:12: vertex -9 is out of range"},
      {positions + "f 1 2 0\n", "'0' is not the number of a vertex"},
      {positions + "f 1 2 x\n", "'x' is not the number"},
      {positions + "f 1//1 2//1 3//1\n", "normal 1 is out of range"},
      {"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", ":4: vertex 2 is not finite"},
      {"v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 2 is not finite"},
      {"v 0 0\nf 1 1 1\n", ":1: a vertex needs three numbers"},
      {"v 0,5 0 0\n", ":1: '0,5' is not a number"},
      {positions, "has no triangles"},
      {positions + "l 1 2\np 3\n", "has no triangles"},
      {"", "is empty"},
      {std::string("\xFF\xFEv\0 \0", 6), "UTF-16"},
      {std::string("v\0 \0000\0", 6), "is not text"},
  };
  for (const auto& [text, message] : files) {
    EXPECT_THAT(error("a.obj", text), HasSubstr(message));
    EXPECT_THAT(error("a.obj", text), HasSubstr(folder.path() + "/a.obj"));
  }
  EXPECT_THAT(log("w.obj", replaced(box, "v -0.3 0 -0.3\n", "v -0.3 0 -0.3 2\n")),
              HasSubstr("1 vertices have a weight"));
}

TEST_F(Import, PolygonsBecomeTheirTriangles) {
  const auto area = [&](const std::string& text) {
    double sum = 0.0;
    const ImportedMesh mesh = read("p.obj", text);
    for (const uvec3& t : mesh.triangles) {
      const dvec3 across =
          glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
      EXPECT_GE(across.z, 0.0) << "no triangle may lie outside and be turned";
      sum += across.z / 2.0;
    }
    return sum;
  };
  EXPECT_NEAR(area("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n"), 4.0, 1e-12) << "an arrow's head";
  EXPECT_NEAR(area("v 1 1 0\nv 0 4 0\nv 0 0 0\nv 4 0 0\nf 1 2 3 4\n"), 4.0, 1e-12);
  EXPECT_NEAR(area("v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6\n"), 5.0, 1e-12) << "an L";
  EXPECT_NEAR(area("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                   "f 1 2 3 4 1 5 6 7 8 5\n"),
              12.0, 1e-12)
      << "a hole by a bridge";
  std::string comb = "v 0 -1 0\nv 41 -1 0\n", circle, face = "f 1 2";
  for (int i = 0; i < 40; ++i) {
    comb += fmt::format("v {} {} 0\n", 40 - i, i % 2 ? 0.0 : 5.0);
    face += fmt::format(" {}", i + 3);
  }
  EXPECT_NEAR(area(comb + face + "\n"), 39 * 3.5 + 0.5 * 6 + 0.5 * 1, 1e-9);
  face = "f";
  for (int i = 0; i < 1000; ++i)  // more corners than a byte counts
    circle += fmt::format("v {:.17g} {:.17g} 0\n", std::cos(2 * pi * i / 1000), std::sin(2 * pi * i / 1000)),
        face += fmt::format(" {}", i + 1);
  EXPECT_NEAR(area(circle + face + "\n"), pi, 1e-4);
}

TEST_F(Import, FarCoordinatesOfPolygonsDoNotMatter) {
  std::vector<dvec3> corners = {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  const auto near = triangulate(corners);
  for (dvec3& c : corners) c += dvec3(5e6, -7e6, 3e6);
  EXPECT_EQ(near, triangulate(corners));
  EXPECT_EQ(polygon_normal(corners), dvec3(0, 0, 10));
}

TEST_F(Import, TheBunnyIsWhatItsFileSays) {
  const ImportedMesh mesh = import_mesh(asset_file("bunny", "mesh"));
  EXPECT_EQ(mesh.positions.size(), 34835u);
  EXPECT_EQ(mesh.triangles.size(), 69666u);
  EXPECT_TRUE(mesh.normals.empty());
}

}  // namespace
}  // namespace penumbra::test
