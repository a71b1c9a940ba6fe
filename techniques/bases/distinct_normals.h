// Receivers that share normals share whatever depends on the normal alone: all of a plane, none of a bunny.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

struct DistinctNormals {
  std::vector<vec3> normals;         ///< empty if there are more than asked for
  std::vector<std::uint16_t> index;  ///< per receiver

  bool few() const { return !normals.empty(); }

  /// At most `most`: beyond, sharing no longer pays for the memory.
  static DistinctNormals of(const std::vector<vec3>& normals, std::size_t most = 8) {
    DistinctNormals found;
    found.index.assign(normals.size(), 0);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      auto at = std::find(found.normals.begin(), found.normals.end(), normals[i]);
      if (at == found.normals.end()) {
        if (found.normals.size() == most) return {};
        at = found.normals.insert(at, normals[i]);
      }
      found.index[i] = std::uint16_t(at - found.normals.begin());
    }
    return found;
  }
};

}  // namespace penumbra
