// The smaller commands of the command line. All throw Error for wrong input.
#pragma once

#include <string>

#include "scenes/fit/fit.h"
#include "techniques/parameters.h"

namespace penumbra {

void list(bool json);

struct RenderOptions {
  std::string scene, technique, backend = "simd", output;
  Parameters parameters;
};
void render(const RenderOptions& options);

struct ReferenceOptions {
  std::string scene, rung = "truth", output;
  double noise = 0.002;
  int resolution = 32;
  bool fresh = false, json = false;
};
void reference(const ReferenceOptions& options);

struct FitOptions {
  std::string mesh;    ///< asset, shape or file
  std::string output;  ///< .json; beside it a picture of the same name in .png
  FitRequest request;
};
/// Fits spheres, writes them and a picture, prints what they are worth.
void fit(const FitOptions& options);

}  // namespace penumbra
