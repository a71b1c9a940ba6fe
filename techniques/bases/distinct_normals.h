// Receivers that share normals share whatever depends on the normal alone: all of a plane, none of a bunny.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "scenes/receivers.h"

namespace penumbra {

struct DistinctNormals {
  static constexpr std::size_t most = 8;  ///< beyond, sharing no longer pays for the memory
  std::vector<vec3> normals;              ///< empty if there are more than `most`
  std::vector<std::uint8_t> index;        ///< per receiver

  bool few() const { return !normals.empty(); }

  static DistinctNormals of(const Receivers& receivers) {
    DistinctNormals found;
    found.index.assign(receivers.normal.size(), 0);
    for (std::size_t i = 0; i < receivers.normal.size(); ++i) {
      auto at = std::find(found.normals.begin(), found.normals.end(), receivers.normal[i]);
      if (at == found.normals.end()) {
        if (found.normals.size() == most) return {};
        at = found.normals.insert(at, receivers.normal[i]);
      }
      found.index[i] = std::uint8_t(at - found.normals.begin());
    }
    return found;
  }
};

}  // namespace penumbra
