// Which things hang together.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace penumbra {

/// Sets that grow together.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  unsigned of(unsigned i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(unsigned a, unsigned b) { parent_[std::max(of(a), of(b))] = std::min(of(a), of(b)); }

 private:
  std::vector<unsigned> parent_;
};

}  // namespace penumbra
