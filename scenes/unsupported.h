// What is not wrong, but cannot be. Apart from Error, whose formatting library CUDA's compiler does not take.
#pragma once

#include <stdexcept>

namespace penumbra {

/// The combination makes no sense (a technique that needs spheres on a scene without any): the row is skipped.
class Unsupported : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace penumbra
