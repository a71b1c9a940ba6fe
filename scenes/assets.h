// Assets by name: one table, scenes/assets.toml, says which file and which package brings it.
#pragma once

#include <string>
#include <vector>

#include "scenes/data_folder.h"  // IWYU pragma: export
#include "scenes/mesh.h"

namespace penumbra {

struct Asset {
  std::string name, kind;  ///< kind: "mesh" or "environment"
  std::string file, package, licence;
  std::string member;  ///< of the archive that `file` is; empty if it is none
};

const std::vector<Asset>& assets();

/// File of a named asset of a kind; empty if no asset has this name. A member of an archive is unpacked into the cache
/// folder when it is first asked for. Throws Error naming the package if the asset is known but its file is not there.
std::string asset_file(const std::string& name, const std::string& kind);

/// Names of all assets of a kind, separated by commas, for messages.
std::string asset_names(const std::string& kind);

/// A shape ("torus-knot"), an asset ("bunny") or a mesh file. Throws Error.
Mesh mesh_by_name(const std::string& name_or_path);

/// A shipped name ("bunny-city") or a path, as a path: PATH itself if it exists or ends in .toml, else
/// data_folder()/folder/NAME.toml. Throws Error listing the shipped names.
std::string shipped_file(const std::string& name, const std::string& folder);
/// Names of the files NAME.toml of data_folder()/folder, sorted.
std::vector<std::string> shipped_names(const std::string& folder);

}  // namespace penumbra
