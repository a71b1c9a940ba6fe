// Where the data lies that penumbra ships with: scenes, suites, the table of assets.
#pragma once

#include <string>

namespace penumbra {

/// Folder that holds assets.toml, library/ and suites/: $PENUMBRA_DATA; else share/penumbra/scenes of the installation
/// that the running program belongs to; else where the sources were built from. Throws Error if it is not there.
std::string data_folder();

}  // namespace penumbra
