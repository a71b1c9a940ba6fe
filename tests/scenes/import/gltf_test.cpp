#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/scenes/import/import_test.h"

namespace penumbra::test {
namespace {

using nlohmann::json;

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? (unsigned char)bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

/// A glTF that grows by accessors; its one buffer is told at the end.
struct Gltf {
  json root = {{"asset", {{"version", "2.0"}}},
               {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"mesh", 0}}}},
               {"meshes", {{{"primitives", {{{"attributes", json::object()}}}}}}}};
  std::string data;

  json& primitive() { return root["meshes"][0]["primitives"][0]; }
  /// Elements of `components` numbers, each padded to `stride` bytes (0: packed).
  template <class T>
  int add(const std::vector<double>& values, int component_type, int components, std::size_t stride = 0) {
    while (data.size() % 4) data += '\0';
    const std::size_t first = data.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const T value = static_cast<T>(values[i]);
      data.append(reinterpret_cast<const char*>(&value), sizeof value);
      const std::size_t used = std::size_t(components) * sizeof(T);
      if (stride && (i + 1) % std::size_t(components) == 0) data.append(stride - used, '\x7f');
    }
    json view = {{"buffer", 0}, {"byteOffset", first}, {"byteLength", data.size() - first}};
    if (stride) view["byteStride"] = stride;
    root["bufferViews"].push_back(view);
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", values.size() / std::size_t(components)},
                                 {"type", components == 1 ? "SCALAR" : "VEC3"}});
    return int(root["accessors"].size()) - 1;
  }
  std::string text(const std::string& uri = "") {
    const std::string inline_data = "data:application/octet-stream;base64," + base64(data);
    root["buffers"] = {{{"byteLength", data.size()}, {"uri", uri.empty() ? inline_data : uri}}};
    return root.dump();
  }
  std::string glb() {
    root["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = root.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary = data;
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto word = [](std::size_t n) {
      const auto value = static_cast<std::uint32_t>(n);
      return std::string(reinterpret_cast<const char*>(&value), 4);
    };
    return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" + text +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

std::vector<double> corners(double scale = 1.0) {
  std::vector<double> out;
  for (const auto& corner : box_corners)
    for (const double c : corner) out.push_back(std::round(1e6 * c * scale) / 1e6);
  return out;
}

std::vector<double> indices() {
  std::vector<double> out;
  for (const auto& f : box_faces)
    for (const int k : {0, 1, 2, 0, 2, 3}) out.push_back(f[k]);
  return out;
}

constexpr int byte_type = 5120, ubyte_type = 5121, short_type = 5122, ushort_type = 5123, uint_type = 5125,
              float_type = 5126;

Gltf box() {
  Gltf file;
  file.primitive()["attributes"]["POSITION"] = file.add<float>(corners(), float_type, 3);
  file.primitive()["indices"] = file.add<std::uint16_t>(indices(), ushort_type, 1);
  return file;
}

TEST_F(Import, GltfBoxIsFlatWithoutNormals) {
  for (const ImportedMesh& mesh : {read("a.gltf", box().text()), read("a.glb", box().glb()), read("x", box().text()),
                                   read("x.obj", box().glb()), read("a.gltf", "\xEF\xBB\xBF" + box().text())}) {
    expect_box(mesh, "box", 24);
    expect_flat(mesh, "box");
  }
}

TEST_F(Import, GltfTransformsThatMirrorKeepTheOutside) {
  const json transforms[] = {
      {{"scale", {-1, 1, 1}}},
      {{"scale", {-1, -1, -1}}, {"translation", {0, 0.6, 0}}},
      {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1}}},
      {{"scale", {1, 1, 1}}, {"rotation", {0, 0.7071067811865476, 0, 0.7071067811865476}}},
  };
  for (const bool normals : {false, true})
    for (const json& transform : transforms) {
      Gltf file = box();
      file.root["nodes"][0].update(transform);
      if (normals) {  // flat ones, corner by corner
        std::vector<double> p, n;
        const std::vector<double> c = corners(), order = indices();
        for (std::size_t i = 0; i < order.size(); ++i) {
          const unsigned* f = box_faces[i / 6];
          const auto at = [&](unsigned v) { return dvec3(c[3 * v], c[3 * v + 1], c[3 * v + 2]); };
          const dvec3 normal = glm::normalize(glm::cross(at(f[1]) - at(f[0]), at(f[2]) - at(f[0])));
          for (int k = 0; k < 3; ++k) p.push_back(at(unsigned(order[i]))[k]), n.push_back(normal[k]);
        }
        file.primitive().erase("indices");
        file.primitive()["attributes"]["POSITION"] = file.add<float>(p, float_type, 3);
        for (double& v : n) v *= 127;
        file.primitive()["attributes"]["NORMAL"] = file.add<std::int8_t>(n, byte_type, 3, 4);
        file.root["accessors"].back()["normalized"] = true;
      }
      const ImportedMesh mesh = read("a.gltf", file.text());
      expect_box(mesh, transform.dump(), 24);
      expect_flat(mesh, transform.dump());
    }
}

TEST_F(Import, GltfNormalsOfStretchedNodesStayPerpendicular) {
  Gltf file;
  file.primitive()["attributes"]["POSITION"] = file.add<float>({0, 0, 0, 1, -1, 0, 0, 0, 1}, float_type, 3);
  file.primitive()["attributes"]["NORMAL"] = file.add<float>({-1, -1, 0, -1, -1, 0, -1, -1, 0}, float_type, 3);
  file.root["nodes"][0]["scale"] = {4, 1, 1};
  const ImportedMesh mesh = read("a.gltf", file.text());
  EXPECT_NEAR(glm::dot(dvec3(mesh.normals[0]), glm::normalize(dvec3(4, -1, 0))), 0.0, 1e-7);
}

TEST_F(Import, GltfQuantizedPositions) {
  struct Case {
    int type;
    bool normalized;
    double scale, node;
  };
  for (const Case& c :
       {Case{short_type, false, 1000, 0.001}, Case{short_type, true, 32767, 1}, Case{ushort_type, true, 65535, 1},
        Case{byte_type, false, 100, 0.01}, Case{ubyte_type, false, 100, 0.01}}) {
    const bool is_signed = c.type == short_type || c.type == byte_type;
    Gltf file;
    std::vector<double> p = corners();
    for (std::size_t i = 0; i < p.size(); ++i)
      p[i] = std::round(c.scale * (p[i] + (is_signed || i % 3 == 1 ? 0.0 : 0.3)));
    int accessor = 0;
    if (c.type == short_type) accessor = file.add<std::int16_t>(p, c.type, 3, 8);
    if (c.type == ushort_type) accessor = file.add<std::uint16_t>(p, c.type, 3, 8);
    if (c.type == byte_type) accessor = file.add<std::int8_t>(p, c.type, 3, 4);
    if (c.type == ubyte_type) accessor = file.add<std::uint8_t>(p, c.type, 3, 12);
    file.root["accessors"][0]["normalized"] = c.normalized;
    file.primitive()["attributes"]["POSITION"] = accessor;
    file.primitive()["indices"] = file.add<std::uint8_t>(indices(), ubyte_type, 1);
    file.root["nodes"][0]["scale"] = {c.node, c.node, c.node};
    file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    EXPECT_NEAR(volume(read("a.gltf", file.text())), 0.216, 1e-4) << c.type << c.normalized;
  }
}

TEST_F(Import, GltfExtensions) {
  for (const char* fine : {"KHR_materials_unlit", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual"}) {
    Gltf file = box();
    file.root["extensionsUsed"] = file.root["extensionsRequired"] = {fine};
    EXPECT_EQ(log("a.gltf", file.text()), "") << fine;
  }
  for (const char* other : {"EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "ACME_x"}) {
    Gltf file = box();
    file.root["extensionsUsed"] = file.root["extensionsRequired"] = {other};
    EXPECT_THAT(error("a.gltf", file.text()), HasSubstr(std::string("requires the extension ") + other));
    EXPECT_THAT(error("a.glb", file.glb()), HasSubstr(std::string("requires the extension ") + other));
  }
  Gltf file = box();
  file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  expect_box(read("a.gltf", file.text()), "Draco is Assimp's", 24);
  expect_flat(read("a.gltf", file.text()), "Draco is Assimp's");
  file.root["extensionsRequired"].push_back("KHR_mesh_quantization");
  EXPECT_THAT(error("a.gltf", file.text()), HasSubstr("KHR_draco_mesh_compression"));
  file.root.erase("extensionsRequired");
  file.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  EXPECT_THAT(log("a.gltf", file.text()), HasSubstr("optional extension EXT_mesh_gpu_instancing"));
}

TEST_F(Import, GltfBuffersByName) {
  const std::pair<const char*, const char*> names[] = {{"my box.bin", "my%20box.bin"},     {"my box.bin", "my box.bin"},
                                                       {"b\xC3\xA4r.bin", "b%C3%A4r.bin"}, {"a+b.bin", "a+b.bin"},
                                                       {"100%.bin", "100%25.bin"},         {"50%20.bin", "50%20.bin"},
                                                       {"sub/x.bin", "sub/x.bin"}};
  std::filesystem::create_directory(folder.path() + "/sub");
  for (const auto& [name, uri] : names) {
    Gltf file = box();
    const std::string path = folder.write(name, file.data + "longer than said");
    expect_box(read("a.gltf", file.text(uri)), uri, 24);
    std::filesystem::remove(path);
    EXPECT_THAT(error("a.gltf", file.text(uri)), HasSubstr("is missing; put that file beside it")) << uri;
  }
  Gltf file = box();
  for (const char* type : {"data:;base64,", "data:application/gltf-buffer;base64,", "data:a/b;charset=utf-8;base64,"})
    expect_box(read("a.gltf", file.text(type + base64(file.data))), type, 24);
}

TEST_F(Import, GltfImagesDoNotMatter) {
  Gltf file = box();
  file.root["images"] = {{{"uri", "nothere.png"}}, {{"uri", "data:image/png;base64,!"}}, {{"bufferView", 99}}};
  file.root["textures"] = {{{"source", 7}}};
  expect_box(read("a.gltf", file.text()), "images", 24);
}

TEST_F(Import, GltfScenesAndInstances) {
  Gltf file = box();
  file.root["nodes"] = {{{"children", {1, 2}}, {"translation", {1000000.25, 0, 0}}},
                        {{"mesh", 0}},
                        {{"mesh", 0}, {"translation", {2, 0, 0}}, {"scale", {2, 2, 2}}},
                        {{"mesh", 0}}};
  EXPECT_NEAR(volume(read("a.gltf", file.text())), 9 * 0.216, 1e-6);
  EXPECT_EQ(log("a.gltf", file.text()), "") << "translations are in double";
  file.root.erase("scene");
  EXPECT_NEAR(volume(read("a.gltf", file.text())), 9 * 0.216, 1e-6) << "the first scene";
  file.root.erase("scenes");
  EXPECT_NEAR(volume(read("a.gltf", file.text())), 10 * 0.216, 1e-6) << "no scene: all roots";
  file.root.erase("nodes");
  EXPECT_NEAR(volume(read("a.gltf", file.text())), 0.216, 1e-6) << "no nodes: all meshes";
  file.root["nodes"] = {{{"children", {1}}}, {{"children", {0}}, {"mesh", 0}}};
  file.root["scenes"] = {{{"nodes", {0}}}};
  EXPECT_THAT(error("a.gltf", file.text()), HasSubstr("below itself"));
}

TEST_F(Import, GltfModesOfTriangles) {
  for (const int mode : {4, 5, 6}) {
    Gltf file;
    const std::vector<double> p = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, fan = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    file.primitive()["attributes"]["POSITION"] = file.add<float>(mode == 6 ? fan : p, float_type, 3);
    file.primitive()["mode"] = mode;
    if (mode == 4) file.primitive()["indices"] = file.add<std::uint32_t>({0, 1, 2, 1, 3, 2}, uint_type, 1);
    file.root["meshes"][0]["primitives"].push_back(file.primitive());
    file.root["meshes"][0]["primitives"][1]["mode"] = 1;  // lines
    const ImportedMesh mesh = read("a.gltf", file.text());
    EXPECT_EQ(mesh.triangles.size(), 2u) << mode;
    EXPECT_EQ(mesh.positions.size(), 4u) << mode;
    for (const vec3& n : mesh.normals) EXPECT_EQ(n, vec3(0, 0, 1)) << mode;
  }
}

TEST_F(Import, GltfSparseAccessors) {
  Gltf file = box();
  std::vector<double> flattened = corners();
  for (std::size_t i = 1; i < flattened.size(); i += 3) flattened[i] = 0;
  const int at = file.add<std::uint8_t>({2, 3, 6, 7}, ubyte_type, 1);
  const int with = file.add<float>({-0.3, 0.6, -0.3, 0.3, 0.6, -0.3, -0.3, 0.6, 0.3, 0.3, 0.6, 0.3}, float_type, 3);
  const int base = file.add<float>(flattened, float_type, 3);
  file.root["accessors"][base]["sparse"] = {{"count", 4},
                                            {"indices", {{"bufferView", at}, {"componentType", ubyte_type}}},
                                            {"values", {{"bufferView", with}}}};
  file.primitive()["attributes"]["POSITION"] = base;
  expect_box(read("a.gltf", file.text()), "sparse", 24);
  file.root["accessors"][base].erase("bufferView");  // zeros
  EXPECT_EQ(read("a.gltf", file.text()).triangles.size(), 6u) << "four corners fall together";
}

TEST_F(Import, GltfSkinsAndMorphTargetsAreSaid) {
  Gltf file = box();
  file.root["nodes"][0]["skin"] = 0;
  file.primitive()["targets"] = {{{"POSITION", 0}}};
  EXPECT_THAT(log("a.gltf", file.text()), testing::AllOf(HasSubstr("has skins"), HasSubstr("has morph targets")));
}

TEST_F(Import, GltfErrorsSayWhatIsWrong) {
  const auto with = [](const char* pointer, const json& value) {
    Gltf file = box();
    file.root[json::json_pointer(pointer)] = value;
    return file.text();
  };
  const std::pair<std::string, const char*> files[] = {
      {"{", "JSON cannot be read"},
      {"{}", "version null"},
      {with("/accessors/0/count", 9), "reaches past bufferViews[0]"},
      {with("/accessors/0/count", 1000000000000), "more than its buffer"},
      {with("/accessors/0/byteOffset", 4), "reaches past"},
      {with("/accessors/0/count", -1), "accessors[0]"},
      {with("/accessors/0/type", "VEC2"), "holds VEC2 where VEC3"},
      {with("/accessors/0/componentType", 5130), "type 5130"},
      {with("/bufferViews/0/byteLength", 10000), "bufferViews[0] reaches past"},
      {with("/bufferViews/1/buffer", 3), "names buffers[3]"},
      {with("/nodes/0/mesh", 3), "names meshes[3]"},
      {with("/scene", 3), "names scenes[3]"},
      {with("/nodes/0/scale", {1, 2}), "scale of a node has 2 numbers"},
      {with("/nodes/0/mesh", "box"), "the importer failed"},
      {with("/meshes/0/primitives/0/mode", 0), "has no triangles"},
      {replaced(box().text(), ";base64,", ";base64,*"), "not base64"},
      {replaced(box().text(), ";base64,", ";base64,=="), "0 bytes where 168 are said"},
      {box().glb().substr(0, 400), "cut off"},
  };
  for (const auto& [text, message] : files) {
    EXPECT_THAT(error("a.gltf", text), HasSubstr(message));
    EXPECT_THAT(error("a.gltf", text), HasSubstr(folder.path() + "/a.gltf: "));
  }
}

}  // namespace
}  // namespace penumbra::test
