// Layers of an image file by the names of its channels: "light.R" is the red of layer "light"; OpenEXR's parts have
// names too.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace penumbra {

/// A group of channels that is a picture.
struct Layer {
  enum class Kind { rgb, grey, chroma };  ///< chroma: OpenEXR's Y, RY, BY

  int part = 0;
  std::string part_name;  ///< empty where the file has but one
  std::string name;       ///< empty for channels without a layer
  Kind kind = Kind::rgb;
  std::array<int, 3> channels{};  ///< R G B, or Y Y Y, or Y RY BY
  int alpha = -1;                 ///< channel, or -1

  /// What chooses it: "part", "layer" or "part.layer".
  std::string address() const;
};

/// The pictures among the channels of one part, in the file's order. Depth, vectors, ids and the like are none.
std::vector<Layer> find_layers(int part, const std::string& part_name, const std::vector<std::string>& channels);

/// The layer called `wanted`, by layer, part or "part.layer". If `wanted` is empty, the one without a name, else the
/// only one there is. Throws Error that lists the layers if there is none or more than one.
Layer choose_layer(const std::vector<Layer>& layers, const std::string& wanted, const std::string& path);

}  // namespace penumbra
