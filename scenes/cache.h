// The folder where results that are dear to compute wait for the next run, and the names they have there.
#pragma once

#include <OpenImageIO/hash.h>

#include <string>
#include <vector>

#include "scenes/mesh.h"

namespace penumbra {

/// $PENUMBRA_CACHE, else $XDG_CACHE_HOME/penumbra, else ~/.cache/penumbra.
std::string cache_folder();

/// SHA-1 over everything that a cached result depends on.
class ContentHash {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    const std::uint64_t size = values.size();
    add_value(size);
    sha_.append(values.data(), values.size() * sizeof(T));
  }
  template <class T>
  void add_value(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    sha_.append(&value, sizeof value);
  }
  void add_vec(vec3 v) {
    for (int c = 0; c < 3; ++c) add_value(v[c]);
  }
  void add_mesh(const Mesh& mesh) { add(mesh.positions), add(mesh.triangles); }
  std::string digest() { return sha_.digest(); }

 private:
  OIIO::SHA1 sha_;
};

}  // namespace penumbra
