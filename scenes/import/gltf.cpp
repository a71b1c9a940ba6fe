#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "scenes/import/gltf_document.h"
#include "scenes/import/readers.h"

namespace penumbra {
namespace {

using glm::dmat3;
using glm::dmat4;
using nlohmann::json;

constexpr std::string_view draco_extension = "KHR_draco_mesh_compression";

/// Whether a surface stays where it is without the extension.
bool leaves_geometry(std::string_view extension) {
  constexpr std::string_view kinds[] = {"KHR_materials_", "KHR_texture_",  "KHR_lights_",          "KHR_animation_",
                                        "KHR_xmp",        "KHR_technique", "EXT_texture_",         "EXT_lights_",
                                        "MSFT_texture_",  "MSFT_packing_", "KHR_mesh_quantization"};
  return std::any_of(std::begin(kinds), std::end(kinds), [&](auto kind) { return extension.starts_with(kind); });
}

/// Assimp decodes Draco, but does not know what else may be required beside it.
bool needs_draco(const json& root) {
  bool draco = false;
  for (const std::string& extension : root.value("extensionsRequired", std::vector<std::string>())) {
    if (extension == "KHR_mesh_quantization" || (extension != draco_extension && !leaves_geometry(extension)))
      return false;
    draco |= extension == draco_extension;
  }
  return draco;
}

dmat4 transform_of(const json& node, const GltfDocument& file) {
  const auto numbers = [&](const char* key, std::vector<double> otherwise) {
    const std::size_t size = otherwise.size();
    std::vector<double> values = node.value(key, std::move(otherwise));
    if (values.size() != size)
      file.fail("the {} of a node has {} numbers, not {}; save it again", key, values.size(), size);
    return values;
  };
  if (node.contains("matrix")) {
    const std::vector<double> m = numbers("matrix", std::vector<double>(16));
    dmat4 matrix;
    for (std::size_t i = 0; i < 16; ++i) matrix[int(i / 4)][int(i % 4)] = m[i];
    return matrix;
  }
  const auto t = numbers("translation", {0, 0, 0}), r = numbers("rotation", {0, 0, 0, 1}),
             s = numbers("scale", {1, 1, 1});
  const dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2])));
  return {glm::dvec4(s[0] * turn[0], 0.0), glm::dvec4(s[1] * turn[1], 0.0), glm::dvec4(s[2] * turn[2], 0.0),
          glm::dvec4(t[0], t[1], t[2], 1.0)};
}

class GltfReader {
 public:
  GltfReader(GltfDocument& file, const std::string& path, Outbox& says) : file_(file), path_(path), says_(says) {}
  RawMesh read();

 private:
  void check_extensions();
  void add_node(std::size_t index, const dmat4& parent);
  void add_mesh(std::size_t index, const dmat4& to_world);
  void add_primitive(const json& primitive, const dmat4& to_world);
  void add_positions(const json& attributes, const dmat4& to_world);
  std::vector<std::size_t> roots() const;

  GltfDocument& file_;
  const std::string& path_;
  Outbox& says_;
  RawMesh mesh_;
  std::vector<bool> seen_;  // nodes
  bool skinned_ = false, morphed_ = false;
};

void GltfReader::check_extensions() {
  const json& root = file_.root();
  for (const std::string& extension : root.value("extensionsRequired", std::vector<std::string>()))
    if (!leaves_geometry(extension))
      file_.fail("requires the extension {}, which is not understood; save it without (gltf-transform or Blender can)",
                 extension);
  for (const std::string& extension : root.value("extensionsUsed", std::vector<std::string>()))
    if (!leaves_geometry(extension) && extension != draco_extension &&
        extension != "EXT_meshopt_compression")  // optional: the same mesh is there uncompressed
      says_.warn(fmt::format("{}: the optional extension {} is not understood and left out", path_, extension));
}

/// Of the scene that is to be shown; without scenes, nodes that are nobody's children.
std::vector<std::size_t> GltfReader::roots() const {
  const json& root = file_.root();
  if (root.contains("scene") || !root.value("scenes", json::array()).empty())
    return file_.item("scenes", root.value("scene", std::size_t(0))).value("nodes", std::vector<std::size_t>());
  const json nodes = root.value("nodes", json::array());
  std::vector<bool> child(nodes.size(), false);
  for (const json& node : nodes)
    for (const std::size_t c : node.value("children", std::vector<std::size_t>()))
      if (c < child.size()) child[c] = true;
  std::vector<std::size_t> out;
  for (std::size_t n = 0; n < child.size(); ++n)
    if (!child[n]) out.push_back(n);
  return out;
}

RawMesh GltfReader::read() {
  check_extensions();
  const json& root = file_.root();
  const std::size_t nodes = root.value("nodes", json::array()).size();
  seen_.assign(nodes, false);
  for (const std::size_t node : roots()) add_node(node, dmat4(1.0));
  for (std::size_t m = 0; nodes == 0 && m < root.value("meshes", json::array()).size(); ++m) add_mesh(m, dmat4(1.0));
  if (skinned_) says_.info(fmt::format("{}: has skins; the mesh is read as it was bound, without bones", path_));
  if (morphed_) says_.info(fmt::format("{}: has morph targets; the mesh is read without them", path_));
  return std::move(mesh_);
}

void GltfReader::add_node(std::size_t index, const dmat4& parent) {
  const json& node = file_.item("nodes", index);
  if (seen_[index]) file_.fail("node {} hangs at two places or below itself; save it again", index);
  seen_[index] = true;
  const dmat4 to_world = parent * transform_of(node, file_);
  skinned_ |= node.contains("skin");
  if (node.contains("mesh")) add_mesh(node["mesh"], to_world);
  for (const std::size_t child : node.value("children", std::vector<std::size_t>())) add_node(child, to_world);
}

void GltfReader::add_mesh(std::size_t index, const dmat4& to_world) {
  for (const json& primitive : file_.item("meshes", index).at("primitives")) add_primitive(primitive, to_world);
}

void GltfReader::add_positions(const json& attributes, const dmat4& to_world) {
  const std::size_t accessor = attributes.at("POSITION");
  const std::vector<double> p = file_.numbers(accessor, "VEC3");
  std::vector<dvec3> local;
  for (std::size_t i = 0; i + 2 < p.size(); i += 3) local.emplace_back(p[i], p[i + 1], p[i + 2]);
  for (const dvec3& position : local) mesh_.positions.emplace_back(to_world * glm::dvec4(position, 1.0));
  const dmat3 linear(to_world);
  const double scale = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  if (file_.item("accessors", accessor)["componentType"] == 5126)
    mesh_.spacing = std::max(mesh_.spacing, scale * float_spacing(local));
  if (!attributes.contains("NORMAL")) return;
  const dmat3 for_normals = glm::transpose(glm::inverse(linear));
  const std::vector<double> n = file_.numbers(attributes["NORMAL"], "VEC3");
  if (n.size() != p.size()) file_.fail("has {} normals for {} positions; save it again", n.size() / 3, p.size() / 3);
  for (std::size_t i = 0; i + 2 < n.size(); i += 3)
    mesh_.normals.push_back(for_normals * dvec3(n[i], n[i + 1], n[i + 2]));
}

void GltfReader::add_primitive(const json& primitive, const dmat4& to_world) {
  constexpr int triangles = 4, strip = 5, fan = 6;
  const int mode = primitive.value("mode", triangles);
  const json& attributes = primitive.at("attributes");
  if (mode < triangles || mode > fan || !attributes.contains("POSITION")) return;
  morphed_ |= primitive.contains("targets");
  const std::size_t first = mesh_.positions.size(), first_normal = mesh_.normals.size();
  const std::size_t first_triangle = mesh_.triangles.size();
  add_positions(attributes, to_world);
  const std::size_t vertices = mesh_.positions.size() - first;
  const bool has_normals = attributes.contains("NORMAL");
  std::vector<Corner> corners;
  const auto add_corner = [&](double index) {
    if (!(index < double(vertices))) file_.fail("a triangle names vertex {} of {}; save it again", index, vertices);
    const auto i = static_cast<unsigned>(index);
    corners.push_back({unsigned(first) + i, has_normals ? unsigned(first_normal) + i : no_normal});
  };
  if (primitive.contains("indices"))
    for (const double index : file_.numbers(primitive["indices"], "SCALAR")) add_corner(index);
  else
    for (std::size_t i = 0; i < vertices; ++i) add_corner(double(i));

  const bool mirrored = glm::determinant(dmat3(to_world)) < 0.0;
  const std::size_t step = mode == triangles ? 3 : 1;
  for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
    const Corner triangle[3] = {corners[mode == fan ? 0 : i], corners[i + 1], corners[i + 2]};
    mesh_.add_polygon(triangle, has_normals, mirrored != (mode == strip && i % 2 == 1));
  }
  for (std::size_t t = first_triangle; !has_normals && t < mesh_.triangles.size(); ++t)
    mesh_.make_flat(mesh_.triangles[t]);  // as the specification demands
}

}  // namespace

RawMesh read_gltf(const std::string& path, Outbox& says) {
  GltfDocument file(path);
  if (file.version_1()) return read_with_assimp(path, says);
  if (needs_draco(file.root())) {
    RawMesh mesh = read_with_assimp(path, says);
    for (RawTriangle& t : mesh.triangles)
      if (!t.file_normals) mesh.make_flat(t);
    return mesh;
  }
  return GltfReader(file, path, says).read();
}

}  // namespace penumbra
