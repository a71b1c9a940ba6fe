#include <assimp/commonMetaData.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>

#include "scenes/error.h"
#include "scenes/import/readers.h"

namespace penumbra {
namespace {

using glm::dmat3;
using glm::dmat4;

dmat4 matrix_of(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

dvec3 vector_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

void append(const aiMesh& part, const dmat4& to_world, const std::string& path, RawMesh& out) {
  const auto first = static_cast<unsigned>(out.positions.size());
  const auto first_normal = static_cast<unsigned>(out.normals.size());
  const dmat3 linear(to_world);
  const dmat3 for_normals = glm::transpose(glm::inverse(linear));
  const bool mirrored = glm::determinant(linear) < 0.0, has_normals = part.HasNormals();
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    out.positions.emplace_back(to_world * glm::dvec4(vector_of(part.mVertices[v]), 1.0));
    if (has_normals) out.normals.push_back(for_normals * vector_of(part.mNormals[v]));
  }
  std::vector<Corner> corners;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    corners.clear();
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      const unsigned i = face.mIndices[k];
      if (i >= part.mNumVertices)
        throw Error("{}: a face names vertex {} of {}; repair the mesh and save it again", path, i, part.mNumVertices);
      corners.push_back({first + i, has_normals ? first_normal + i : no_normal});
    }
    out.add_polygon(corners, has_normals, mirrored);
  }
}

void append(const aiScene& scene, const aiNode& node, const dmat4& parent, const std::string& path, RawMesh& out) {
  const dmat4 to_world = parent * matrix_of(node.mTransformation);
  for (unsigned m = 0; m < node.mNumMeshes; ++m) append(*scene.mMeshes[node.mMeshes[m]], to_world, path, out);
  for (unsigned c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], to_world, path, out);
}

bool comes_from(const aiScene& scene, std::initializer_list<std::string_view> formats) {
  aiString source;
  if (!scene.mMetaData || !scene.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, source)) return false;
  const std::string_view name = source.C_Str();
  return std::any_of(formats.begin(), formats.end(), [&](auto format) { return name.find(format) != name.npos; });
}

}  // namespace

RawMesh read_with_assimp(const std::string& path, Outbox&) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // else bones become bodies
  const aiScene* scene = importer.ReadFile(path, 0);
  if (!scene || !scene->mRootNode)
    throw Error("{}: cannot be read as a mesh ({}); save it as OBJ, PLY or glTF", path, importer.GetErrorString());
  RawMesh mesh;
  append(*scene, *scene->mRootNode, dmat4(1.0), path, mesh);
  mesh.facets = comes_from(*scene, {"STL"});
  if (comes_from(*scene, {"3DS", "ASE", "LWO"}))  // Assimp makes their normals from the triangles and their groups
    for (RawTriangle& t : mesh.triangles) t.file_normals = false;
  mesh.spacing = float_spacing(mesh.positions);
  return mesh;
}

}  // namespace penumbra
