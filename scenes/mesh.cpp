#include "scenes/mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>

#include "scenes/error.h"

namespace penumbra {

Bounds bounds(const Mesh& mesh) {
  if (mesh.positions.empty()) return {};
  Bounds box{mesh.positions[0], mesh.positions[0]};
  for (const vec3& p : mesh.positions) {
    box.low = glm::min(box.low, p);
    box.high = glm::max(box.high, p);
  }
  return box;
}

std::vector<vec3> vertex_normals(const Mesh& mesh) {
  std::vector<dvec3> sum(mesh.positions.size(), dvec3(0.0));
  for (const uvec3& t : mesh.triangles) {
    const dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const dvec3 n = glm::cross(b - a, c - a);  // length is twice the area
    for (int k = 0; k < 3; ++k) sum[t[k]] += n;
  }
  std::vector<vec3> normals(sum.size(), vec3(0.0f));
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double length = glm::length(sum[i]);
    if (length > 0.0) normals[i] = vec3(sum[i] / length);
  }
  return normals;
}

namespace {

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, Mesh& out) {
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

Mesh load_mesh(const std::string& path) {
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
  Mesh mesh;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  validate(mesh, path);
  return mesh;
}

void validate(const Mesh& mesh, const std::string& what) {
  if (mesh.empty()) throw Error("{}: the mesh has no triangles", what);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec3& p = mesh.positions[i];
    if (!glm::all(glm::lessThan(glm::abs(p), vec3(std::numeric_limits<float>::max()))))
      throw Error("{}: vertex {} is not finite ({}, {}, {})", what, i, p.x, p.y, p.z);
  }
  for (const uvec3& t : mesh.triangles)
    if (glm::any(glm::greaterThanEqual(t, uvec3(static_cast<unsigned>(mesh.positions.size())))))
      throw Error("{}: a triangle names vertex {} of {}", what, std::max({t.x, t.y, t.z}), mesh.positions.size());
}

Similarity fit_to(const Bounds& box, float height, bool on_ground) {
  Similarity fit;
  if (height > 0.0f && box.extent().y > 0.0f) fit.scale = height / box.extent().y;
  const vec3 centre = fit.scale * box.centre();
  fit.offset = {-centre.x, on_ground ? -fit.scale * box.low.y : 0.0f, -centre.z};
  return fit;
}

}  // namespace penumbra
