// Readers of single formats; each runs in a child process (guard.h) and throws Error naming the file.
#pragma once

#include "scenes/import/raw_mesh.h"

namespace penumbra {

/// Wavefront OBJ: v, vn, f, s; numbers correctly rounded to double. Own code, since tinyobjloader 2.0 rounds half of
/// all six-decimal coordinates wrongly (to 2e-10 at 5e5), reads `nan` as 0, wraps polygons at 256 corners, skips faces
/// that name vertices which are not there, and cannot tell `s off` from no `s`; Assimp 5.2 holds single precision.
RawMesh read_obj(const std::string& path, Outbox& says);

/// Polygon File Format, ASCII and binary of either byte order. Own code: no package of Debian 12 reads it apart from
/// Assimp, whose binary reader crashes where the data begin with a newline.
RawMesh read_ply(const std::string& path, Outbox& says);

/// glTF 2.0, text and binary, with nlohmann-json. Not with tinygltf 2.7, which takes + in names of buffers for a blank,
/// also looks for them in the working folder, and refuses buffers longer than said and data URIs of most media types.
RawMesh read_gltf(const std::string& path, Outbox& says);

/// Whatever Assimp knows, in single precision.
RawMesh read_with_assimp(const std::string& path, Outbox& says);

}  // namespace penumbra
