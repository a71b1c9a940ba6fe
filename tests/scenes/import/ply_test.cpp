#include <bit>
#include <cstring>

#include "tests/scenes/import/import_test.h"

namespace penumbra::test {
namespace {

/// Numbers as a PLY file of one format holds them.
class Body {
 public:
  Body(bool ascii, bool big_endian) : ascii_(ascii), big_endian_(big_endian) {}
  template <class T>
  void add(T value) {
    if (ascii_) {
      text_ += fmt::format("{} ", value);
      return;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof value);
    if (big_endian_ == (std::endian::native == std::endian::little)) std::reverse(bytes, bytes + sizeof(T));
    text_.append(bytes, sizeof(T));
  }
  void end_row() {
    if (ascii_) text_ += "\n";
  }
  const std::string& text() const { return text_; }

 private:
  bool ascii_, big_endian_;
  std::string text_;
};

struct Names {
  const char *coordinate, *count, *index;
};

template <class Coordinate, class Count, class Index>
std::string box(const std::string& format, const Names& names, const std::string& line_end = "\n") {
  std::string header = fmt::format(
      "ply\nformat {} 1.0\ncomment made here\nobj_info of a box\nelement vertex 8\nproperty {} x\nproperty {} y\n"
      "property {} z\nelement face 6\nproperty list {} {} vertex_indices\nend_header\n",
      format, names.coordinate, names.coordinate, names.coordinate, names.count, names.index);
  Body body(format == "ascii", format == "binary_big_endian");
  for (const auto& corner : box_corners) {
    for (const double c : corner) body.add(static_cast<Coordinate>(c));
    body.end_row();
  }
  for (const auto& face : box_faces) {
    body.add(static_cast<Count>(4));
    for (const unsigned i : face) body.add(static_cast<Index>(i));
    body.end_row();
  }
  return replaced(header, "\n", line_end) + (format == "ascii" ? replaced(body.text(), "\n", line_end) : body.text());
}

const char* const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

TEST_F(Import, PlyFormatsTypesAndLineEnds) {
  for (const std::string format : formats)
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      const std::string what = format + (end == "\n" ? " LF" : end == "\r" ? " CR" : " CRLF");
      expect_box(read("a.ply", box<float, int, int>(format, {"float", "int", "int"}, end)), what);
      expect_box(read("a.ply", box<double, unsigned, unsigned short>(format, {"float64", "uint32", "ushort"}, end)),
                 what);
      expect_box(read("a.ply", box<double, short, unsigned>(format, {"double", "int16", "uint"}, end)), what);
    }
  const std::string bytes =
      box<float, unsigned char, unsigned char>("binary_little_endian", {"float", "uchar", "uint8"});
  expect_box(read("a.ply", bytes), "bytes");
  expect_box(read("misnamed.obj", bytes), "known by its content");
  expect_box(read("A.PLY", "\xEF\xBB\xBF" + box<float, int, int>("ascii", {"float", "int", "int"})), "byte-order mark");
}

/// The first byte of the data looks like white space, and belongs to them nevertheless.
TEST_F(Import, PlyDataMayBeginWithANewline) {
  for (const std::string end : {"\n", "\r\n", "\r"})
    for (const char first : {'\n', '\r', ' '}) {
      std::string text = box<float, unsigned char, int>("binary_little_endian", {"float", "uchar", "int"}, end);
      const std::size_t data = text.find("end_header") + 10 + end.size();
      text[data] = first;  // the last digits of -0.3
      EXPECT_NEAR(volume(read("a.ply", text)), 0.216, 1e-5);
      Body body(false, true);
      for (const int i : {first << 24, 0, 0, 0, 1, 0, 0, 0, 1, 3, 0, 1, 2}) body.add(i);
      const std::string head =
          "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty int x\nproperty int y\nproperty int z\n"
          "element face 1\nproperty list int int vertex_indices\nend_header\n";
      EXPECT_EQ(read("b.ply", replaced(head, "\n", end) + body.text()).positions[0].x, double(first << 24));
    }
}

TEST_F(Import, PlyKeepsDoubles) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty double z\nelement face "
      "1\n"
      "property list uchar int vertex_index\nend_header\n500000.123456 4649776.654321 0\n500001 4649776 0\n"
      "500000 4649777 0\n3 0 1 2\n";
  EXPECT_EQ(read("a.ply", text).positions[0], dvec3(500000.123456, 4649776.654321, 0));
  Body body(false, true);
  for (const double d : {500000.123456, 1.0, 2.0, 500001.0, 1.0, 2.0, 500000.0, 2.0, 2.0}) body.add(d);
  for (const int i : {3, 0, 1, 2}) body.add(i);
  const std::string head =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list int int vertex_index\nend_header\n";
  EXPECT_EQ(read("b.ply", head + body.text()).positions[0].x, 500000.123456);
}

TEST_F(Import, PlyPropertiesAndElementsInAnyOrder) {
  for (const std::string format : formats) {
    Body body(format == "ascii", format == "binary_big_endian");
    body.add(7), body.end_row();  // another element before
    for (int i = 0; i < 2; ++i)
      body.add(short(2)), body.add(0.5), body.add(1.5), body.add(std::int8_t(65)), body.end_row();
    for (const auto& f : box_faces) {  // faces before vertices, with lists around
      body.add(1.5f), body.add(short(3)), body.add(0.0f), body.add(1.0f), body.add(2.0f);
      body.add(short(4));
      for (const unsigned i : f) body.add(static_cast<short>(i));
      body.add(9), body.end_row();
    }
    for (const auto& c : box_corners) {
      const dvec3 n = glm::normalize(dvec3(c[0], c[1] - 0.3, c[2]));
      body.add(float(n.z)), body.add(c[2]), body.add(short(1)), body.add(short(5)), body.add(c[0]);
      body.add(float(n.x)), body.add(float(n.y)), body.add(c[1]), body.end_row();
    }
    const ImportedMesh mesh = read(
        "a.ply", fmt::format("ply\nformat {} 1.0\nelement nothing 1000000000000\nelement id 1\nproperty int number\n"
                             "element edge 2\nproperty list short double weights\nproperty char letter\n"
                             "element face 6\nproperty float quality\nproperty list short float texcoord\n"
                             "property list short short vertex_index\nproperty int flags\nelement vertex 8\n"
                             "property float nz\nproperty double z\nproperty list short short extra\n"
                             "property double x\nproperty float nx\nproperty float ny\nproperty double y\nend_header\n",
                             format) +
                     body.text());
    expect_box(mesh, format);
    ASSERT_EQ(mesh.normals.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i)
      EXPECT_LT(glm::distance(dvec3(mesh.normals[i]), glm::normalize(mesh.positions[i] - dvec3(0, 0.3, 0))), 1e-6);
  }
}

TEST_F(Import, PlyOrientationFollowsNormals) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "nx\n"
      "property float ny\nproperty float nz\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& c : box_corners)
    text += fmt::format("{} {} {} {} {} {}\n", c[0], c[1], c[2], c[0], c[1] - 0.3, c[2]);
  for (const auto& f : box_faces) text += fmt::format("4 {} {} {} {}\n", f[3], f[2], f[1], f[0]);
  expect_box(read("a.ply", text), "clockwise");
}

TEST_F(Import, PlyTriangleStrips) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n"
      "9 0 1 2 3 4 -1 0 1 2\n";
  const ImportedMesh mesh = read("a.ply", text);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  for (const uvec3& t : mesh.triangles)
    EXPECT_GT(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).z, 0.0);
}

TEST_F(Import, PlyErrorsSayWhatIsWrong) {
  const std::string good = box<float, unsigned char, int>("binary_little_endian", {"float", "uchar", "int"});
  const std::string text = box<float, unsigned char, int>("ascii", {"float", "uchar", "int"});
  const std::pair<std::string, const char*> files[] = {
      {"hello", "does not begin with 'ply'"},
      {"ply\nformat ascii 1.0\n", "no end_header"},
      {good.substr(0, good.size() - 5), "cut off"},
      {good.substr(0, good.size() - 120), "cut off"},
      {text.substr(0, text.size() - 6), "cut off"},
      {replaced(good, "vertex 8", "vertex 4000000000"), "too few bytes for 4000000000 of 'vertex'"},
      {replaced(text, "face 6", "face 900000000000000000"), "too few bytes"},
      {replaced(text, "vertex 8", "vertex -8"), "'-8' is not a number of elements"},
      {replaced(text, "\n4 0 4 6 2", "\n2000000000 0 4 6 2"), "list of 2000000000"},
      {replaced(text, "\n4 0 4 6 2", "\n4 0 4 6 8"), "names vertex 8"},
      {replaced(text, "\n4 0 4 6 2", "\n4 0 4 6 -2"), "names vertex -2"},
      {replaced(text, "-0.3 0 0.3", "-0.3 x 0.3"), "no number"},
      {replaced(text, "-0.3 0 0.3", "-0.3 nan 0.3"), "is not finite"},
      {replaced(text, "ascii", "utf"), "format 'utf'"},
      {replaced(text, "property float x", "property colour x"), "'colour' is not a type"},
      {replaced(text, "property float x", "property float u"), "no x, y and z"},
      {replaced(text, "vertex_indices", "texture"), "no list vertex_indices"},
      {replaced(text, "element face 6", "element face 0"), "has no triangles"},
  };
  for (const auto& [bytes, message] : files) {
    EXPECT_THAT(error("a.ply", bytes), HasSubstr(message));
    EXPECT_THAT(error("a.ply", bytes), HasSubstr(folder.path() + "/a.ply: "));
  }
  expect_box(
      read("nan.ply", replaced(replaced(text, "vertex 8", "vertex 9"), "\n4 1 3 7 5", "\nnan nan nan\n4 1 3 7 5")),
      "points that belong to no face may be no numbers");
}

/// Single-precision numbers half a million from zero are 1/32 apart.
TEST_F(Import, LostPrecisionIsSaid) {
  const auto far_box = [](auto zero) {
    using T = decltype(zero);
    Body body(false, false);
    for (const auto& c : box_corners) body.add(T(c[0] + 500000)), body.add(T(c[1])), body.add(T(c[2]));
    for (const auto& f : box_faces) {
      body.add(static_cast<unsigned char>(4));
      for (const unsigned i : f) body.add(int(i));
    }
    const char* type = sizeof(T) == 4 ? "float" : "double";
    return fmt::format(
               "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty {0} x\nproperty {0} y\n"
               "property {0} z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n",
               type) +
           body.text();
  };
  EXPECT_THAT(log("far.ply", far_box(0.0f)), HasSubstr("up to 0.016 of the file's units, 2.5 % of the mesh"));
  EXPECT_EQ(log("far.ply", far_box(0.0)), "");
}

}  // namespace
}  // namespace penumbra::test
