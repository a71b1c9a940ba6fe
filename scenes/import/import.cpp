#include "scenes/import/import.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>

#include "scenes/error.h"

namespace penumbra {
namespace {

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, ImportedMesh& out) {
  const aiMatrix4x4 to_world = parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const auto first = static_cast<unsigned>(out.positions.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = to_world * part.mVertices[v];
      out.positions.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices == 3)
        out.triangles.push_back(uvec3(face.mIndices[0], face.mIndices[1], face.mIndices[2]) + first);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) append_node(scene, *node.mChildren[c], to_world, out);
}

void reject_invalid(const aiScene& scene, const std::string& path) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned v = 0; v < scene.mMeshes[m]->mNumVertices; ++v) {
      const aiVector3D p = scene.mMeshes[m]->mVertices[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        throw Error("{}: vertex {} of part {} is not finite ({}, {}, {})", path, v, m, p.x, p.y, p.z);
    }
}

}  // namespace

ImportedMesh import_mesh(const std::string& path) {
  if (!std::filesystem::exists(path)) throw Error("{}: no such mesh file", path);
  Assimp::Importer importer;
  // Normals and texture coordinates split vertices at seams; without them equal positions are joined.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TEXCOORDS | aiComponent_COLORS |
                                                          aiComponent_MATERIALS | aiComponent_TANGENTS_AND_BITANGENTS);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene) {
    reject_invalid(*scene, path);  // before joining: a NaN vertex compares equal to any other and would vanish
    scene = importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate |
                                         aiProcess_JoinIdenticalVertices);
  }
  if (!scene || !scene->mRootNode)
    throw Error("{}: cannot be read as a mesh ({}); OBJ, PLY, 3DS and glTF are supported", path,
                importer.GetErrorString());
  ImportedMesh mesh;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  if (mesh.triangles.empty()) throw Error("{}: the mesh has no triangles", path);
  return mesh;
}

}  // namespace penumbra
